"""`python -m rainwind`: the command line."""

from rainwind.cli import main

main()
