"""An assessment as a report to file: PDF, HTML, Excel and CSV."""
