"""Imports go down: every import of the package is read from its syntax tree, those inside functions too."""

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

PACKAGE = "rainwind"
SOURCE = Path(__file__).parents[1] / "src" / PACKAGE
FLOORS = {
    "errors": 0, "parameters": 0, "elementary": 0,
    "dynamics": 1, "physics": 1,
    "engineering": 2,
    "io": 3, "plotting": 3,
    "studies": 4,
    "reporting": 4,  # an assessment as pages and tables: templates, typst, Excel
    "cli_output": 4, "cli_work": 4,  # what the floor above prints and how it waits; they know no study
    "cli_time": 5, "cli_maps": 5, "cli_assess": 5,  # commands that cli adds to its program
    "cli": 6, "app": 6, "__main__": 7,
}  # fmt: skip
FORBIDDEN_NAMES = {"utils", "helpers", "core", "base", "misc"}
ONLY_IN = {
    "matplotlib": {"plotting", "studies", "reporting"},
    "xarray": {"io"},
    "h5netcdf": {"io"},
    "netCDF4": {"io"},
    "pint": {"io"},
    "openpyxl": {"io", "reporting"},
    "typst": {"reporting"},
}

# `to_xarray` of a trajectory and an ensemble, when it is called
ALSO_IN = {
    ("xarray", f"{PACKAGE}.dynamics.trajectory"),
    ("xarray", f"{PACKAGE}.dynamics.ensemble_results"),
}


def modules(source: Path) -> dict[str, Path]:
    """Dotted name -> file of every module below `source`."""
    found = {}
    for path in sorted(source.rglob("*.py")):
        parts = path.relative_to(source).with_suffix("").parts
        found[".".join((PACKAGE, *(parts[:-1] if parts[-1] == "__init__" else parts)))] = path
    return found


def imports_of(name: str, path: Path) -> Iterator[tuple[str, int]]:
    """Absolute dotted names that a module imports, with the line; `from a import b` gives `a.b`."""
    package = name if path.name == "__init__.py" else name.rpartition(".")[0]
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"), str(path))):
        if isinstance(node, ast.Import):
            yield from ((alias.name, node.lineno) for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            above = package.split(".")[: len(package.split(".")) - node.level + 1] if node.level else []
            origin = ".".join([*above, *([node.module] if node.module else [])])
            yield from ((f"{origin}.{alias.name}", node.lineno) for alias in node.names)
        elif (
            isinstance(node, ast.Call) and _callee(node.func) in ("import_module", "__import__") and node.args
        ):
            target = node.args[0]
            if isinstance(target, ast.JoinedStr):  # f"rainwind.studies.{name}": the room is what counts
                target = target.values[0]
            if isinstance(target, ast.Constant) and isinstance(target.value, str):
                text = target.value.rstrip(".")
                dots = len(text) - len(text.lstrip("."))
                above = package.split(".")[: len(package.split(".")) - dots + 1] if dots else []
                yield ".".join([*above, text.lstrip(".")]), node.lineno


def _callee(function: ast.expr) -> str:
    return getattr(function, "attr", None) or getattr(function, "id", "")


def room(name: str) -> str:
    """The room or floor-0 file of a dotted name; "" for the package's face."""
    parts = name.split(".")
    return parts[1] if len(parts) > 1 else ""


def floor_faults(source: Path) -> list[str]:
    """Every import that goes up or sideways, every file that stands on no floor."""
    known = modules(source)
    faults = [f"{name} stands on no floor" for name in known if room(name) and room(name) not in FLOORS]
    for name, path in known.items():
        for target, line in imports_of(name, path):
            where = f"{path.relative_to(source)}:{line} imports {target}"
            to = _module_of(target, known)
            if target.split(".")[0] != PACKAGE or not room(name) or room(name) not in FLOORS:
                continue
            if to == PACKAGE and room(target) in FLOORS:
                to = target  # a room that is not built yet
            if to == PACKAGE:
                # the face imports everything; its version is a fact that any room may print
                if target != f"{PACKAGE}.__version__":
                    faults.append(f"{where}: the package's face is above")
            elif room(to) not in FLOORS or FLOORS[room(to)] > FLOORS[room(name)]:
                faults.append(f"{where}: up")
            elif FLOORS[room(to)] == FLOORS[room(name)] and room(to) != room(name) and FLOORS[room(to)]:
                faults.append(f"{where}: sideways")
    return faults


def _module_of(target: str, known: dict[str, Path]) -> str:
    """The module that an import reaches: `rainwind.physics.model.RivuletModel` is in `...model`."""
    while target not in known and "." in target:
        target = target.rpartition(".")[0]
    return target


def cycles(source: Path) -> list[list[str]]:
    """Groups of modules that import each other; imports inside functions count."""
    known = modules(source)
    graph = {
        name: {_module_of(target, known) for target, _ in imports_of(name, path)}
        & set(known) - {name, PACKAGE}
        for name, path in known.items()
    }
    found: list[list[str]] = []
    for start in graph:
        trail, seen = [(start, [start])], set()
        while trail:
            at, path = trail.pop()
            for after in graph[at]:
                if after == start:
                    found.append([*path, start])
                elif after not in seen:
                    seen.add(after)
                    trail.append((after, [*path, after]))
    return found


def outside_imports(source: Path) -> list[str]:
    """Imports of libraries that belong to certain rooms only."""
    return [
        f"{path.relative_to(source)}:{line} imports {target}"
        for name, path in modules(source).items()
        for target, line in imports_of(name, path)
        if room(name) not in ONLY_IN.get(target.split(".")[0], {room(name)})
        and (target.split(".")[0], name) not in ALSO_IN
    ]


def forbidden_names(source: Path) -> list[str]:
    return [name for name in modules(source) if FORBIDDEN_NAMES & set(name.split("."))]


def test_imports_go_down():
    assert floor_faults(SOURCE) == []


def test_no_module_imports_itself_in_a_circle():
    assert cycles(SOURCE) == []


def test_libraries_stay_in_their_rooms():
    assert outside_imports(SOURCE) == []


def test_names_say_what_is_inside():
    assert forbidden_names(SOURCE) == []


def test_no_path_of_a_machine_in_the_package():
    texts = {
        path: path.read_text(encoding="utf-8")
        for path in SOURCE.rglob("*")
        if path.suffix in (".py", ".toml")
    }
    places = ("shared/", "/work/", "/home/", "/root/", "C:\\Users")
    assert [str(path) for path, text in texts.items() if any(place in text for place in places)] == []


@pytest.fixture
def tree(tmp_path: Path):
    """Writes a package of our shape: file -> text."""

    def write(files: dict[str, str]) -> Path:
        for name, text in files.items():
            path = tmp_path / PACKAGE / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text, encoding="utf-8")
        return tmp_path / PACKAGE

    return write


@pytest.mark.parametrize(
    ("file", "text", "fault"),
    [
        ("physics/wind.py", "from rainwind.io.cases import read_case", "up"),
        ("physics/wind.py", "def f():\n    import rainwind.studies", "up"),
        ("physics/wind.py", "from rainwind.dynamics import tape", "sideways"),
        ("dynamics/tape.py", "from ..physics import wind", "sideways"),
        ("dynamics/tape.py", "from rainwind import RivuletModel", "face"),
        ("dynamics/tape.py", "import rainwind", "face"),
        ("errors.py", "from rainwind.physics import wind", "up"),
        ("io/cases.py", "import importlib\nimportlib.import_module('rainwind.studies.paper')", "up"),
        ("io/cases.py", "import importlib\nimportlib.import_module(f'rainwind.cli.{1}')", "up"),
        ("io/cases.py", "from ..plotting import axes", "sideways"),
        ("io/cases.py", "from rainwind.attic import x", "face"),
        ("attic.py", "", "no floor"),
    ],
)
def test_the_check_sees_a_wrong_import(tree, file: str, text: str, fault: str):
    source = tree({"__init__.py": "", "physics/wind.py": "", "dynamics/tape.py": "", "studies/paper.py": "",
                   "plotting/axes.py": "", "cli.py": "", file: text})  # fmt: skip
    (found,) = floor_faults(source)
    assert fault in found


def test_the_check_lets_right_imports_pass(tree):
    source = tree(
        {
            "__init__.py": "def __getattr__(name):\n    from rainwind.studies import paper",
            "errors.py": "",
            "parameters.py": "from rainwind.errors import A",
            "physics/wind.py": "from rainwind.errors import A\nfrom .section import B\nimport numpy",
            "physics/section.py": "from rainwind.parameters import C",
            "studies/paper.py": "from rainwind.io import cases\nfrom rainwind import __version__",
            "io/cases.py": "import xarray\nfrom rainwind.physics.wind import Wind",
        }
    )
    assert floor_faults(source) == []
    assert cycles(source) == []
    assert outside_imports(source) == []


def test_the_check_sees_a_circle(tree):
    source = tree({"io/a.py": "from . import b", "io/b.py": "def f():\n    from rainwind.io.c import x",
                   "io/c.py": "import rainwind.io.a"})  # fmt: skip
    assert [set(cycle) for cycle in cycles(source)] == [
        {"rainwind.io.a", "rainwind.io.b", "rainwind.io.c"}
    ] * 3


def test_the_check_sees_libraries_and_names_out_of_place(tree):
    source = tree(
        {"physics/utils.py": "def f():\n    from matplotlib import pyplot", "cli.py": "import xarray"}
    )
    assert len(outside_imports(source)) == 2
    assert forbidden_names(source) == ["rainwind.physics.utils"]
