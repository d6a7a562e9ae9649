"""Drawing with matplotlib: a journal's style, branches and regions. Takes results, returns axes."""
