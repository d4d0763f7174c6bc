# Two commands do all the set-up: `make demo` and `make test`. Everything goes into .venv/ and target/.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
export PIP_DISABLE_PIP_VERSION_CHECK := 1

.PHONY: demo test build develop lint format check clean

$(BIN)/python:
	$(PYTHON) -m venv $(VENV)

$(VENV)/.tools: pyproject.toml | $(BIN)/python
	$(BIN)/python -m pip install --quiet --upgrade "maturin>=1.9,<2"
	touch $@

build: $(VENV)/.tools
	. $(BIN)/activate && maturin develop --release --quiet

develop: $(VENV)/.tools
	. $(BIN)/activate && maturin develop --release --quiet --extras report,bench,dev
