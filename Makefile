# `make bench`: parflex beside Pinocchio, MuJoCo and Exudyn, in an environment of its own.
PYTHON ?= python3
ENVIRONMENT = benchmarks/.venv
QUESTIONS ?=

.PHONY: bench
bench: $(ENVIRONMENT)/installed
	$(ENVIRONMENT)/bin/python -m benchmarks $(QUESTIONS)

$(ENVIRONMENT)/installed: pyproject.toml benchmarks/requirements.txt
	$(PYTHON) -m venv $(ENVIRONMENT)
	$(ENVIRONMENT)/bin/python -m pip install --quiet --editable ".[view]" --requirement benchmarks/requirements.txt
	touch $@
