"""Studies: the paper's figures and what goes beyond them; each computes a result, draws it and tabulates it."""
