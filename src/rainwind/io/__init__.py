"""Cases, tables and results in and out; the only room that knows case files and netCDF."""
