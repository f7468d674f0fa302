"""Executes a notebook, which fails where a cell does.

    python run_notebook.py NOTEBOOK
"""

import sys

import nbformat
from nbclient import NotebookClient

notebook = nbformat.read(sys.argv[1], as_version=4)
NotebookClient(notebook, timeout=300).execute()
print(f"{sys.argv[1]}: {len(notebook.cells)} cells executed")
