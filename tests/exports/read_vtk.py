"""Reads an export for ParaView back with VTK itself, and holds it against the
tables of the same run: read_vtk.py VTK_DIR CSV_DIR."""

import csv
import math
import sys
import xml.etree.ElementTree as ElementTree
from pathlib import Path

from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkCommand
from vtkmodules.vtkFiltersCore import vtkMultiObjectMassProperties, vtkTriangleFilter
from vtkmodules.vtkIOXML import vtkXMLPolyDataReader

GRAIN_ARRAYS = {
    "grain",
    "sieve_fraction",
    "sieve_size_m",
    "mass_kg",
    "speed_m_per_s",
    "displacement_m",
    "coordination_number",
}
CONTACT_ARRAYS = {"first", "second", "force_n", "normal_force_n"}


class Failed(Exception):
    """A law that does not hold."""


def check(law, expected, got, tolerance=0.0):
    """Raises when `got` is farther from `expected` than `tolerance`."""
    same = got == expected if tolerance == 0.0 else abs(got - expected) <= tolerance
    if not same:
        raise Failed(f"law: {law}: expected {expected}, got {got}, tolerance {tolerance}")


def can_fail():
    """The comparison refuses what is too large, too small, or no number."""
    check("", 1.0, 1.1, 0.2)
    for wrong in (0.7, 1.3, math.nan):
        try:
            check("", 1.0, wrong, 0.2)
        except Failed:
            continue
        raise AssertionError(f"{wrong} passed for 1")


def read(path):
    """A .vtp file as VTK reads it; anything it says of it is an error."""
    said = []
    reader = vtkXMLPolyDataReader()
    for event in (vtkCommand.ErrorEvent, vtkCommand.WarningEvent):
        reader.AddObserver(event, lambda _, name: said.append(name))
    check(f"{path} is a file of polygons for VTK", 1, reader.CanReadFile(str(path)))
    reader.SetFileName(str(path))
    reader.Update()
    check(f"what VTK says of {path}", [], said)
    return reader.GetOutput()


def arrays(data):
    """Arrays of points or cells by name."""
    return {data.GetArrayName(n): vtk_to_numpy(data.GetArray(n)) for n in range(data.GetNumberOfArrays())}


def listed(folder, name):
    """Time and file of each entry of a .pvd file."""
    root = ElementTree.parse(folder / f"{name}.pvd").getroot()
    check(f"{name}.pvd is a collection", "Collection", root.get("type"))
    entries = [(float(e.get("timestep")), folder / e.get("file")) for e in root.iter("DataSet")]
    times = [time for time, _ in entries]
    check(f"times of {name}.pvd rise", sorted(set(times)), times)
    for time, path in entries:
        data = read(path)
        value = data.GetFieldData().GetArray("TimeValue")
        check(f"time in {path}", time, value.GetValue(0))
        yield time, path, data


def solids(data):
    """Number and volume in m3 of the closed bodies that the polygons make, by
    VTK's own filters, which also check that each is closed."""
    triangles = vtkTriangleFilter()
    triangles.SetInputData(data)
    mass = vtkMultiObjectMassProperties()
    mass.SetInputConnection(triangles.GetOutputPort())
    mass.Update()
    check("every body is closed", 1, mass.GetAllValid())
    return mass.GetNumberOfObjects(), mass.GetTotalVolume()


def table(path):
    with open(path, newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def number(name):
    """The number of a grain by its name in the tables."""
    return int(name.removeprefix("grain_"))


def grains(folder, tables):
    """Every grain file, and the last one against the table of grains."""
    last = None
    count = 0
    for _, path, data in listed(folder, "grains"):
        cells = arrays(data.GetCellData())
        check(f"arrays of {path}", GRAIN_ARRAYS, set(cells))
        check(f"cells of {path} are polygons", data.GetNumberOfPolys(), data.GetNumberOfCells())
        for name, values in cells.items():
            check(f"entries of {name} in {path}", data.GetNumberOfCells(), len(values))
        last = data, cells
        count += 1
    data, cells = last
    rows = [row for row in tables["grains"] if row["fate"] == "present"]
    check("grains at the end", {number(row["grain"]) for row in rows}, set(cells["grain"].tolist()))
    expected = sum(1e-9 * float(row["volume_mm3"]) for row in rows)
    bodies, got = solids(data)
    check("closed bodies", len(rows), bodies)
    check("volume of the grains in m3", expected, got, 1e-5 * expected)
    mass_of = {number(row["grain"]): 1e-3 * float(row["mass_g"]) for row in rows}
    speed_of = {
        number(row["grain"]): math.hypot(
            *(1e-3 * float(row[f"velocity_{a}_mm_per_s"]) for a in "xyz")
        )
        for row in rows
    }
    for grain, mass, speed in zip(cells["grain"], cells["mass_kg"], cells["speed_m_per_s"]):
        check(f"mass of grain {grain} in kg", mass_of[int(grain)], float(mass), 1e-6 * float(mass))
        check(f"speed of grain {grain} in m/s", speed_of[int(grain)], float(speed), 1e-6)
    x0, x1, y0, y1, z0, z1 = data.GetBounds()
    reach = max(-x0, x1, -y0, y1)
    if not (reach < 0.07 and z0 > -0.002 and z1 < 0.2):
        raise Failed(f"law: the grains lie in the cylinder, got the bounds {data.GetBounds()}")
    touching = sum(2 for _ in tables["pairs"]) / len(rows)
    number_of = dict(zip(cells["grain"].tolist(), cells["coordination_number"].tolist()))
    check("mean coordination number", touching, sum(number_of.values()) / len(number_of), 1e-9)
    return count


def apparatus(folder, moments):
    count = 0
    for _, path, data in listed(folder, "apparatus"):
        check(f"arrays of {path}", {"part"}, set(arrays(data.GetCellData())))
        count += 1
    check("apparatus at each moment", moments, count)


def contacts(folder, tables):
    ends = 0
    for _, path, data in listed(folder, "contacts"):
        points = arrays(data.GetPointData())
        check(f"arrays of {path}", CONTACT_ARRAYS | {"force_vector_n", "normal"}, set(points))
        check(f"cells of {path} are points", data.GetNumberOfVerts(), data.GetNumberOfPoints())
        last = points
        ends += 1
    rows = tables["contacts"]
    check("contacts at the end", len(rows), len(last["force_n"]))
    for row, force, vector in zip(rows, last["force_n"], last["force_vector_n"]):
        expected = math.hypot(*(float(row[f"force_{a}_n"]) for a in "xyz"))
        check("force of a contact in N", expected, float(force), 1e-6 * max(expected, 1.0))
        check("length of its vector", float(force), math.hypot(*map(float, vector)), 1e-5)
    chains = 0
    for _, path, data in listed(folder, "force_chains"):
        check(f"arrays of {path}", CONTACT_ARRAYS, set(arrays(data.GetCellData())))
        check(f"cells of {path} are lines", data.GetNumberOfLines(), data.GetNumberOfCells())
        check(f"points of {path}", 2 * data.GetNumberOfLines(), data.GetNumberOfPoints())
        last_lines = data.GetNumberOfLines()
        chains += 1
    check("files of chains", ends, chains)
    bodies = {tuple(sorted((row["first"], row["second"]))) for row in rows}
    check("lines are pairs of bodies", len(bodies), last_lines)
    return ends


def main():
    can_fail()
    folder, csv_folder = map(Path, sys.argv[1:3])
    tables = {name: table(csv_folder / f"{name}.csv") for name in ("grains", "contacts", "pairs")}
    moments = grains(folder, tables)
    apparatus(folder, moments)
    ends = contacts(folder, tables)
    print(f"VTK reads {moments} moments and {ends} ends of stages without a word")


try:
    main()
except Failed as why:
    sys.exit(str(why))
