"""The command line as a shell meets it: HOODOO is the program (ctest sets it), hoodoo(...) runs it."""
import os
import pathlib
import resource
import subprocess

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent.parent
HOODOO = os.environ.get("HOODOO", str(ROOT / "build/release/bin/hoodoo"))

SCENE = """version = 1
[params]
height = 3
[camera]
eye = [0, -10, "= height"]
target = [0, 0, 0]
[film]
width = 64
height = 36
[render]
spp = 4
[terrain.floor]
type = "plane"
material = "sand"
[light.sky]
type = "constant"
radiance = { grey = 0.5 }
"""

# A sanitizer maps terabytes of shadow memory, so a limit of the address space would only stop the sanitizer itself.
SANITIZED = os.environ.get("HOODOO_SANITIZED") == "1"


def hoodoo(*arguments, env=None, cwd=None, timeout=120, limit=None):
    def limits():
        resource.setrlimit(resource.RLIMIT_AS, (limit, limit))

    return subprocess.run([HOODOO, *map(str, arguments)], capture_output=True, text=True, timeout=timeout, cwd=cwd,
                          env={**os.environ, **(env or {})}, preexec_fn=limits if limit and not SANITIZED else None)
