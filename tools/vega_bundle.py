"""Write the script bundle that every report carries, python/gmr/data/vega/, and the licences of its parts.

    python tools/vega_bundle.py

needs vl-convert-python (the extra ``[report]``), which holds the scripts, and ``npm``, from whose packages
the licence texts are taken. Run it to move to a newer Vega; the browser tests say whether the page works.
"""

from __future__ import annotations

import json
import subprocess
import tempfile
from pathlib import Path
from typing import Final

import vl_convert

TARGET: Final = Path(__file__).resolve().parent.parent / "python" / "gmr" / "data" / "vega"
COMMAND_LINE_ONLY: Final = frozenset({"commander", "iconv-lite", "rw", "yargs", "tslib"})
"""Dependencies of the programs that come with some packages; the libraries do not load them."""


def versions() -> dict[str, str]:
    """Package -> version of the three libraries that the bundle is made of."""
    return {
        "vega": vl_convert.get_vega_version(),
        "vega-lite": max(vl_convert.get_vegalite_versions(), key=lambda text: [*map(int, text.split("."))]),
        "vega-embed": vl_convert.get_vega_embed_version(),
    }


def licences(packages: dict[str, str]) -> str:
    """The licence texts of the packages and of all that they load, each once, under the packages' names."""
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "package.json").write_text(json.dumps({"dependencies": packages}), encoding="utf-8")
        subprocess.run(
            ["npm", "install", "--ignore-scripts", "--no-audit", "--no-fund", "--silent"],
            cwd=folder,
            check=True,
        )
        modules = Path(folder) / "node_modules"
        by_text: dict[str, list[str]] = {}
        for package in sorted(loaded(modules, list(packages))):
            by_text.setdefault(licence_text(modules / package), []).append(package)
    return "\n\n".join(f"{', '.join(names)}\n\n{text}" for text, names in by_text.items()) + "\n"


def loaded(modules: Path, packages: list[str]) -> set[str]:
    """The packages and, through their dependencies, all that they load in a browser."""
    found: set[str] = set()
    while packages:
        package = packages.pop()
        if package not in found and package not in COMMAND_LINE_ONLY and not package.startswith("@types/"):
            found.add(package)
            packages += json.loads((modules / package / "package.json").read_text()).get("dependencies", {})
    return found


def licence_text(package: Path) -> str:
    """The text of the one licence file of a package."""
    (file,) = (path for path in package.iterdir() if path.name.upper().startswith("LICENSE"))
    return file.read_text(encoding="utf-8").strip()


def main() -> None:
    """Write the bundle, its versions and its licences."""
    packages = versions()
    # The stub of vl-convert forgets that the first argument may be left out.
    bundle = vl_convert.javascript_bundle(vl_version=packages["vega-lite"])  # type: ignore[call-arg]
    if "</script" in bundle.lower() or "<!--" in bundle:
        raise SystemExit("the bundle holds '</script' or '<!--' and cannot be put into a page as it is")
    TARGET.mkdir(parents=True, exist_ok=True)
    (TARGET / "vega.js").write_text(bundle, encoding="utf-8", newline="\n")
    (TARGET / "versions.json").write_text(json.dumps(packages, indent=2) + "\n", encoding="utf-8")
    (TARGET / "LICENSES.txt").write_text(licences(packages), encoding="utf-8", newline="\n")
    print(f"{TARGET}: {len(bundle):,} bytes of script, {packages}")


if __name__ == "__main__":
    main()
