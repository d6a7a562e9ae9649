# One-word commands; each sets up what it needs. On a fresh machine with Python and make:
#   make paper    reproduces the paper's figures and numbers into paper_out/
#   make test     runs every check that CI runs
PYTHON ?= python3
VENV := .venv
# the folder of the environment's programs: Scripts on Windows, bin elsewhere
BIN := $(VENV)/$(if $(filter Windows_NT,$(OS)),Scripts,bin)
OUT ?= paper_out

.PHONY: paper test lint types benchmark format docs clean

paper: $(VENV)/.user
	$(BIN)/rainwind paper --out $(OUT)

test: lint types
	$(BIN)/python -m pytest -n auto --dist loadfile

lint: $(VENV)/.developer
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .

types: $(VENV)/.developer
	$(BIN)/pyright

docs: $(VENV)/.developer
	$(BIN)/python -m pip install --quiet --constraint constraints.txt --editable '.[docs]'
	$(BIN)/sphinx-build -W docs docs/_build

format: $(VENV)/.developer
	$(BIN)/ruff check --fix .
	$(BIN)/ruff format .

benchmark: $(VENV)/.developer
	$(BIN)/python -m benchmarks

$(VENV)/.user: pyproject.toml constraints.txt
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --constraint constraints.txt --editable .
	touch $@

$(VENV)/.developer: pyproject.toml constraints.txt
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --constraint constraints.txt --editable '.[dev]'
	touch $@ $(VENV)/.user

clean:
	rm -rf $(VENV) $(OUT) build dist
