"""Writes the page of the documentation that compares the models with formulas, standards and data sheets."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING

sys.path.insert(0, str(Path(__file__).parent))

import coupling
import engine
import facilities
import mechanics
import people
import pictures
import seeing
import senses
import sensing
import sun
import traffic
import weather

if TYPE_CHECKING:
    from figures import Figure

DOCS = Path(__file__).parents[2] / "docs"
CHAPTERS = (
    ("Mechanics", mechanics),
    ("Linkages and arms", coupling),
    ("Sensors", sensing),
    ("Cameras", seeing),
    ("Radar, sonar and other senses", senses),
    ("Weather", weather),
    ("People", people),
    ("Belts and lifts", facilities),
    ("Traffic", traffic),
    ("Sun", sun),
    ("The engine", engine),
)
HEAD = """# Validation

This page compares results of the models with formulas and published values. `python -m tools validation` measures
everything again and writes this page; a test does the same and fails if a figure leaves its tolerance.
"""
PICTURES = {
    "Mechanics": """
![Height over distance of a thrown ball: simulation and formula](measured/arc.svg)

The dots are the ball of the simulation, twelve for each second; the line is the formula.

The integrator limits the accuracy of fast spins: the default, `implicitfast`, is of first order, and a top of 20 rad/s
rises by 0.15° per second at a step of 2 ms. A file with `<option integrator="RK4"/>` keeps the tilt to 1e-7°.
""",
    "Sensors": """
![Allan deviation over time of a gyroscope: simulation and data sheet](measured/allan.svg)

The dots are the gyroscope of a simulated BMI088 at rest for 200 s; the line is the white noise of its data sheet.
""",
}


def measured() -> dict[str, list[Figure]]:
    """Return the figures of each chapter."""
    return {title: list(module.figures()) for title, module in CHAPTERS}


def page(chapters: dict[str, list[Figure]]) -> str:
    """Return the text of the page."""
    parts = [HEAD]
    for title, figures in chapters.items():
        parts += [f"\n## {title}\n\n| model | quantity | expected | measured | tolerance | source |\n"]
        parts += ["| --- | --- | --: | --: | --: | --- |\n"]
        parts += [
            f"| {f.model} | {f.quantity} | {f.expected:.6g} | {_rounded(f)} | {f.tolerance:g} | {f.source} |\n"
            for f in figures
        ]
        parts.append(PICTURES.get(title, ""))
    return "".join(parts)


def _rounded(figure: Figure) -> str:
    """The measured value to a hundredth of its tolerance: further digits differ among processors."""
    step = figure.tolerance / 100.0
    return f"{round(figure.measured / step) * step + 0.0:.6g}"


def main() -> int:
    """Write the page and its pictures; the result is the status of the process."""
    chapters = measured()
    (DOCS / "validation.md").write_text(page(chapters), encoding="utf-8")
    for name, draw in (("arc", pictures.arc), ("allan", pictures.allan)):
        (DOCS / "measured" / f"{name}.svg").write_text(draw(), encoding="utf-8")
    wrong = [figure for figures in chapters.values() for figure in figures if not figure.is_right]
    for figure in wrong:
        print(f"{figure.model}: {figure.quantity}: {figure.measured:g}, expected {figure.expected:g}", file=sys.stderr)
    return 1 if wrong else 0
