#!/usr/bin/env python3
"""Fails on an include that points up, and on a paper key in a comment that references.bib does not have.

The layers (design): hosts -> render -> {transport, film, compare, scene}; transport -> {scene, light, media, shading, geometry};
scene -> {geometry, light, media, shading, terrain}; {geometry, shading, light, media} -> terrain; film -> terrain/math.
Inside terrain: catalogue -> surfaces -> {march, edit, rocks, stack} -> fields -> field.h -> math; analysis stands beside stack.
"""
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
TERRAIN_BASE = {"terrain/math", "terrain/field.h", "terrain/density.h", "terrain/surface.h", "terrain/shape.h", "terrain/error.h", "terrain/schema.h", "terrain/isa.h",
                "terrain/isa_kernels.h"}
TERRAIN_PUBLIC = TERRAIN_BASE | {"terrain/catalogue.h", "terrain/editable.h", "terrain/schema_values.h"}
PARAMETERS = {"terrain/math", "terrain/error.h", "terrain/schema.h", "terrain/isa.h"}
MAY_INCLUDE = {
    "terrain/math": set(),
    "terrain/base": TERRAIN_BASE,
    "terrain/fields": TERRAIN_BASE,
    "terrain/analysis": TERRAIN_BASE | {"terrain/fields"},
    "terrain/stack": TERRAIN_BASE | {"terrain/fields"},
    "terrain/edit": TERRAIN_BASE | {"terrain/fields", "terrain/stack"},
    "terrain/rocks": TERRAIN_BASE | {"terrain/stack"},
    "terrain/march": TERRAIN_BASE | {"terrain/fields", "terrain/stack"},
    "terrain/io": TERRAIN_BASE | {"terrain/fields", "terrain/stack"},
    "terrain/surfaces": TERRAIN_PUBLIC | {"terrain/fields", "terrain/stack", "terrain/edit", "terrain/march", "terrain/io", "terrain/rocks"},
    "terrain/catalogue": TERRAIN_PUBLIC | {"terrain/surfaces"},
    "renderer/geometry": TERRAIN_BASE,
    "renderer/shading": TERRAIN_BASE | {"terrain/io/raster.h"},
    "renderer/light": TERRAIN_BASE,
    "renderer/media": TERRAIN_BASE,
    "renderer/film": PARAMETERS | {"terrain/io/atomic_file.h"},
    "renderer/compare": PARAMETERS | {"renderer/film"},
    "renderer/scene": TERRAIN_PUBLIC | {"renderer/geometry", "renderer/light", "renderer/media", "renderer/shading"},
    "renderer/transport": TERRAIN_BASE | {"renderer/scene", "renderer/geometry", "renderer/light", "renderer/media", "renderer/shading",
                                          "renderer/film"},
    "renderer/render": TERRAIN_PUBLIC | {"renderer/scene", "renderer/geometry", "renderer/light", "renderer/media", "renderer/shading",
                                         "renderer/transport", "renderer/film", "renderer/compare", "terrain/io/polygonise.h", "terrain/io/mesh_writer.h", "terrain/io/grid_file.h", "terrain/io/drawing.h",
                                         "terrain/io/height_image.h", "terrain/io/georeference.h", "terrain/stack/column_set.h"},
}


def layer_of(path):
    parts = path.parts
    if parts[0] == "terrain" and len(parts) == 2:
        return "terrain/catalogue" if parts[1].startswith("catalogue") else "terrain/base"
    if parts[0] == "renderer" and len(parts) == 2:
        return "renderer/render"
    return "/".join(parts[:2])


def check_file(path, keys):
    layer = layer_of(path)
    if layer == "renderer/hosts":
        return
    allowed = MAY_INCLUDE[layer] if layer in MAY_INCLUDE else None
    if allowed is None:
        yield f"{path}: the folder {layer} has no place in the layers"
        return
    for number, line in enumerate((ROOT / path).read_text().splitlines(), 1):
        match = re.match(r'\s*#\s*include\s+"((?:terrain|renderer)/[^"]+)"', line)
        if match:
            target = match.group(1)
            folder = "/".join(target.split("/")[:2])
            same = layer == layer_of(pathlib.PurePosixPath(target))
            if not same and folder not in allowed and target not in allowed:
                yield f"{path}:{number}: {layer} may not include {target}"
        for key in re.findall(r"\b([A-Z][A-Za-z]+(?:19|20)\d\d[a-z]?)\b", line.split("//", 1)[1] if "//" in line else ""):
            if key not in keys:
                yield f"{path}:{number}: {key} is not in references.bib"


def main():
    keys = set(re.findall(r"@\w+\{([^,]+),", (ROOT / "references.bib").read_text()))
    files = sorted(p.relative_to(ROOT) for folder in ("terrain", "renderer") for p in (ROOT / folder).rglob("*") if p.suffix in (".h", ".cpp"))
    problems = [problem for path in files for problem in check_file(path, keys)]
    print("\n".join(problems) or f"{len(files)} files, every include points down")
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
