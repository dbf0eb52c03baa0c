# SPDX-License-Identifier: Apache-2.0
"""testWheel.py PROJECT: builds the wheel of the projector alone, offline, installs it in a virtual environment without VTK, and
runs testScene.py and the gallery there.
testWheel.py PROJECT WHEEL: the same with a wheel that was built elsewhere (Packaging/tryWheel.sh).
Exit 125: not asked for (MAMMORAY_LONG_TESTS), nothing to build it with, or no device."""
import importlib.util
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import zipfile

# They say in their first line that they need VTK.
WITH_VTK = ["compression", "stiffness"]
PLY = """ply
format ascii 1.0
element vertex 4
property float x
property float y
property float z
element face 4
property list uchar int vertex_indices
end_header
0 0 0
1 0 0
0 1 0
0 0 1
3 0 2 1
3 0 1 3
3 0 3 2
3 1 2 3
"""


def inside():
    """Run by the interpreter of the environment: which libraries are loaded, and how other meshes are read."""
    import mammoray as mr
    assert mr.devices()
    with open("/proc/self/maps", encoding="utf-8") as maps:
        loaded = {line.split()[-1] for line in maps}
    for library in ("libvulkan.so", "libxrl.so."):
        [path] = [path for path in loaded if library in path]
        assert pathlib.Path(path).parent == pathlib.Path(mr.__file__).parent, path
    try:
        mr.mesh(1, 2)
    except AttributeError as error:
        assert "needs VTK" in str(error), error
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder) / "part.ply"
        path.write_text(PLY, encoding="utf-8")
        if importlib.util.find_spec("meshio"):
            mesh = mr.read_mesh(path, unit="cm")
            assert mesh.points.max() == 10 and mesh.cells.shape == (4, 3) and mesh.file == str(path), mesh
            path.write_text(PLY[:100], encoding="utf-8")
        for missing in (False, True):
            if missing:
                sys.modules["meshio"] = None  # type: ignore[assignment]
            try:
                mr.read_mesh(path)
                raise AssertionError(path)
            except mr.InputError as error:
                assert str(error).startswith(f"{path}: ") and "meshio" in str(error) and "\n" not in str(error), error


def build(root, folder, environment):
    """The wheel, from a copy of the sources: building leaves files behind."""
    for part in ("CMakeLists.txt", "LICENSE", "README.md", "setup.py", "pyproject.toml"):
        shutil.copy(root / part, folder)
    for part in ("Data", "Modules", "Packaging", "Wrapping", "shaders"):
        shutil.copytree(root / part, folder / part)
    subprocess.run([sys.executable, "-m", "pip", "wheel", "--no-index", "--no-build-isolation", "--no-deps", "-w", folder / "wheel", "."],
                   cwd=folder, check=True, env=environment)
    shutil.rmtree(folder / "Data")  # the wheel has its own
    [wheel] = (folder / "wheel").iterdir()
    return wheel


def main():
    if not os.environ.get("MAMMORAY_LONG_TESTS"):
        print("some minutes; set MAMMORAY_LONG_TESTS to run it")
        return 125
    root = pathlib.Path(sys.argv[1]).resolve()
    missing = [module for module in ("pip", "skbuild") if importlib.util.find_spec(module) is None]
    if missing and len(sys.argv) == 2:
        print(f"no {', '.join(missing)}")
        return 125
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"} | {"MPLBACKEND": "Agg"}
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        wheel = pathlib.Path(sys.argv[2]).resolve() if len(sys.argv) > 2 else build(root, folder, environment)
        size = wheel.stat().st_size / 1e6
        print(f"{wheel.name}: {size:.1f} MB")
        assert size < 20
        held = [pathlib.PurePath(each).name for each in zipfile.ZipFile(wheel).namelist()]
        assert {"libvulkan.so", "LICENSE", "copyright.projector", "copyright.wheel"} <= set(held), held

        # numpy and what the gallery draws and fits with are the system's.
        subprocess.run([sys.executable, "-m", "venv", "--system-site-packages", folder / "xray"], check=True)
        python = folder / "xray/bin/python3"
        [packages] = (folder / "xray/lib").glob("python*/site-packages")
        (packages / "vtkmodules.py").write_text("raise ImportError('no VTK here')\n", encoding="utf-8")
        subprocess.run([python, "-m", "pip", "install", "--no-index", wheel], check=True, env=environment)

        def run(*arguments, cwd="/", **variables):
            return subprocess.run([python, *arguments], cwd=cwd, env=environment | variables, check=False, capture_output=True, text=True)
        refused = run("-c", "import mammoray\nmammoray.Projector().device", VK_DRIVER_FILES="/nonexistent", VK_ICD_FILENAMES="/nonexistent")
        said = refused.stderr.splitlines()[-1]
        assert said.startswith("mammoray._errors.DeviceError: no Vulkan: the loader found no driver"), refused.stderr
        print(said)
        for program in ("testScene.py", "testWheel.py"):
            shutil.copy(pathlib.Path(__file__).parent / program, folder)
        scripts = sorted((root / "docs/gallery").glob("*.py"))
        for script in [folder / "testScene.py", folder / "testWheel.py", *scripts]:
            if script.stem in WITH_VTK:
                assert "VTK" in script.read_text(encoding="utf-8").splitlines()[1], script
                continue
            done = run(script, folder, cwd=root if script in scripts else "/", INSIDE="1")
            print(f"{script.name}: {done.returncode}", flush=True)
            if done.returncode:
                print(done.stdout, done.stderr)
                return done.returncode
    return 0


if __name__ == "__main__":
    sys.exit(inside() if os.environ.get("INSIDE") else main())
