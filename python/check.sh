#!/usr/bin/env bash
# What has to hold of the Python package: formatting and lints of its compiled
# part, an installation in a fresh environment, the tests, the notebook.
# Needs Python 3.10 or newer with its package index, beside Rust.
set -euo pipefail
cd "$(dirname "$0")"

cargo fmt --check
cargo clippy --release --locked -- -D warnings
environment=target/check
python3 -m venv --clear "$environment"
"$environment/bin/pip" install --quiet ".[check]"
"$environment/bin/python" -m unittest discover tests
"$environment/bin/mypy" --strict python/couloir
"$environment/bin/python" tests/run_notebook.py \
    examples/from_log_to_diagnosis.ipynb
