#!/usr/bin/env bash
# What has to hold of the Python package: an installation in a fresh
# environment, the tests, the types, the notebook. Needs Python 3.10 or newer
# with its package index, beside Rust. The package is compiled into the
# project's own target folder: where the command was built before, the binding
# alone is new.
set -euo pipefail
cd "$(dirname "$0")"

environment=../target/python
python3 -m venv --clear "$environment"
"$environment/bin/pip" install --quiet ".[check]"
"$environment/bin/python" -m unittest discover tests
"$environment/bin/mypy" --strict python/couloir
"$environment/bin/python" tests/run_notebook.py \
    examples/from_log_to_diagnosis.ipynb
