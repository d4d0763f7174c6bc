# Two commands do all the set-up: `make demo` and `make test`. All they install goes into .venv/, .node/ and target/.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
REPORT ?= gmr-demo/report.html
VALIDATOR := gltf-validator@2.0.0-dev.3.10
BROWSER := x_ite@15.0.1
# maturin lies in .venv/ already, so the build needs no environment of its own.
INSTALL := . $(BIN)/activate && python -m pip install --quiet --no-build-isolation
export PIP_DISABLE_PIP_VERSION_CHECK := 1

.PHONY: demo test build develop check-machine check-rust check-style check-python smoke bench fuzz format clean help

demo: build ## Evaluate the clips that ship with gmr and write the report
	$(BIN)/gmr demo --out $(REPORT)

test: develop ## Everything that a contributor needs before a commit
	$(MAKE) --no-print-directory --jobs=2 --output-sync=line check-rust check-style
	$(MAKE) --no-print-directory check-python smoke

build: $(VENV)/.gmr ## Build gmr into .venv/

develop: $(VENV)/.develop ## Build gmr into .venv/ with all that tests and benchmarks need

bench: develop ## gmr against its peers, on this machine
	$(BIN)/gmr bench

fuzz: develop ## Ten minutes of hostile bytes for each fuzz target
	tools/fuzz.sh

format: develop ## Write all code in the house's format
	cargo fmt --all
	$(BIN)/ruff format .
	$(BIN)/ruff check --fix .

# Cargo is not told of make's own jobs: it cannot reach them, and doc tests would warn of it.
check-rust:
	cargo fmt --all --check
	cargo clippy --workspace --all-targets --quiet -- -D warnings
	cargo clippy --package gmr-core --no-default-features --quiet -- -D warnings
	cargo clippy --manifest-path fuzz/Cargo.toml --target-dir target/fuzz --quiet -- -D warnings
	MAKEFLAGS= cargo test --workspace --quiet
	RUSTDOCFLAGS="-D warnings" cargo doc --workspace --no-deps --quiet

check-style:
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .
	$(BIN)/mypy

check-python:
	$(BIN)/pytest --numprocesses=auto --dist=worksteal

smoke:
	$(BIN)/gmr bench --smoke

clean: ## Remove all that make has made
	rm -rf $(VENV) .node target gmr-demo

help:
	@grep -hE '^[a-z-]+:.*##' $(MAKEFILE_LIST) | sed -E 's/:.*## /\t/' | expand -t 12

SOURCES := Cargo.toml Cargo.lock pyproject.toml $(shell find crates python/gmr -name '*.rs' -o -name Cargo.toml)

# pip must be recent enough to take its build requirements from pyproject.toml.
$(VENV)/.tools: pyproject.toml | check-machine
	@$(PYTHON) -m venv $(VENV)
	@$(BIN)/python -m pip install --quiet --upgrade "maturin>=1.9,<2"
	@touch $@

$(VENV)/.gmr: $(VENV)/.tools $(SOURCES)
	@echo "Building gmr (one to three minutes the first time) ..."
	@$(INSTALL) --editable .
	@touch $@

$(VENV)/.develop: $(VENV)/.gmr
	@echo "Installing what tests and benchmarks need ..."
	@$(INSTALL) --editable ".[report,bench,dev]"
	@npm install --silent --no-audit --no-fund --no-save --prefix .node $(VALIDATOR) $(BROWSER) || \
	echo "npm is missing or has failed: written files will be shown neither to the Khronos glTF-Validator nor to X_ITE."
	@touch $@

check-machine:
	@PYTHON="$(PYTHON)" tools/check_machine.sh
