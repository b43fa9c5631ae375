.PHONY: setup check test fix ci

setup: ## install for development into the active environment
	pip install -e ".[dev]"
	mkdir -p .typing && ln -sfn .. .typing/limbik

check: ## lint, format, types
	ruff check . && ruff format --check . && mypy

test: ## the whole suite; T=tests/test_x.py for one file
	pytest $(T)

fix: ## repair what ruff can
	ruff check --fix . && ruff format .

ci: ## everything, in a fresh environment
	.ci/run
