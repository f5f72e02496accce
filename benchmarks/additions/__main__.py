"""Measures what each addition of the defaults is worth, and writes docs/beyond-the-paper.md.

    python -m benchmarks.additions [--seeds 20] [--write-only]

Results are kept in build/additions.jsonl: what is there is not run again.
"""

import argparse

from benchmarks.additions.cases import SEEDS
from benchmarks.additions.document import document
from benchmarks.additions.runs import load, run_missing
from tests.conftest import ROOT


def main() -> None:
    """Run what is missing, then write the document."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seeds", type=int, default=SEEDS, help="seeds of each case, at most")
    parser.add_argument("--write-only", action="store_true", help="write the document from what was measured")
    args = parser.parse_args()
    if not args.write_only:
        run_missing(args.seeds)
    (ROOT / "docs" / "beyond-the-paper.md").write_text(document(load()), encoding="utf-8")


if __name__ == "__main__":
    main()
