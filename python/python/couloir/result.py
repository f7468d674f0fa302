"""What every result has: its document, its files, its pictures, its draws."""

from __future__ import annotations

import html
import json
import re
from array import array
from csv import reader
from dataclasses import dataclass, field
from os import PathLike
from typing import Any

from couloir import _couloir
from couloir.inference_data import inference_data


@dataclass(frozen=True)
class Figure:
    """A picture, which a notebook shows as it is."""

    name: str
    svg: str = field(repr=False)

    def _repr_svg_(self) -> str:
        return self.svg


@dataclass(frozen=True)
class Draws:
    """Posterior draws, in the order of their chains."""

    chain: array[int] = field(repr=False)
    """The chain of each draw, from 0."""
    columns: dict[str, array[float]] = field(repr=False)
    """The values of each parameter; `numpy.asarray` takes one as it is."""

    def __len__(self) -> int:
        return len(self.chain)


@dataclass(frozen=True)
class Result:
    """What a command made, with the files that it would have written."""

    document: dict[str, Any] = field(repr=False)
    """The JSON document that the command prints."""
    files: dict[str, bytes] = field(repr=False)
    """The files that the command writes, by their names."""
    made: _couloir.Made = field(repr=False, compare=False)

    def save(self, folder: str | PathLike[str]) -> None:
        """Writes the files into a folder, as the command does with `--out`:
        in place of what an earlier run wrote there, and of nothing else.
        """
        self.made.write(folder)

    def figures(self) -> list[Figure]:
        """Its pictures, as SVG."""
        alone = {n: f for n, f in self.files.items() if n.endswith(".svg")}
        if alone:
            return [
                Figure(name.split("/")[-1][:-4], text.decode())
                for name, text in alone.items()
            ]
        page = self.files.get("report.html", b"").decode()
        drawn = r'<figure id="([^"]*)">.*?(<svg.*?</svg>)'
        return [Figure(*one) for one in re.findall(drawn, page, re.DOTALL)]

    def draws(self) -> Draws:
        """Its posterior draws; none where there are none."""
        text = self.files.get("draws.csv", b"chain,iteration\n").decode()
        rows = reader(text.splitlines())
        names = next(rows)[2:]
        chain, columns = array("q"), [array("d") for _ in names]
        for row in rows:
            chain.append(int(row[0]))
            for column, value in zip(columns, row[2:]):
                column.append(float(value))
        return Draws(chain, dict(zip(names, columns)))

    def to_inferencedata(self) -> Any:
        """Its draws as ArviZ's InferenceData, with what they say of the data
        where they are of one model; needs `pip install couloir[arviz]`.
        """
        return inference_data(self.made.groups())

    def _repr_html_(self) -> str | None:
        page = self.files.get("report.html")
        if page is None:
            return None
        inside = html.escape(page.decode(), quote=True)
        return (
            f'<iframe srcdoc="{inside}" width="100%" height="640" '
            'style="border: 0; background: #fff"></iframe>'
        )


def opened(made: _couloir.Made, name: str) -> dict[str, Any]:
    """What every result is made of; the document is the file of this name."""
    files = made.files()
    document = json.loads(files[name])
    return {"document": document, "files": files, "made": made}
