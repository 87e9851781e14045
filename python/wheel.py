# SPDX-License-Identifier: BSD-3-Clause
"""The build back end of pyproject.toml (PEP 517): `pip install .` builds the module with CMake and packs what
`cmake --install --component python` installs. It needs nothing but what scripts/setup installs, so that it works without
a network; CMake's own environment variables count, such as CMAKE_GENERATOR and CMAKE_CXX_COMPILER_LAUNCHER."""
import base64
import hashlib
import os
import pathlib
import subprocess
import sys
import sysconfig
import tarfile
import tempfile
import zipfile

try:
    import tomllib
except ModuleNotFoundError:  # before Python 3.11
    import tomli as tomllib

ROOT = pathlib.Path(__file__).resolve().parents[1]


def _metadata():
    """Name, version, and the text of METADATA, from pyproject.toml."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    lines = ["Metadata-Version: 2.1", f"Name: {project['name']}", f"Version: {project['version']}",
             f"Summary: {project['description']}", "License: BSD-3-Clause",
             f"Requires-Python: {project['requires-python']}", "Description-Content-Type: text/markdown"]
    lines += [f"Classifier: {line}" for line in project["classifiers"]]
    lines += [f"Requires-Dist: {line}" for line in project["dependencies"]]
    for extra, needs in project["optional-dependencies"].items():
        lines += [f"Provides-Extra: {extra}"] + [f"Requires-Dist: {line}; extra == '{extra}'" for line in needs]
    text = "\n".join(lines) + "\n\n" + (ROOT / project["readme"]).read_text()
    return project["name"], project["version"], text


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    """Builds a wheel for the Python that runs this, and returns its name.

    @raises subprocess.CalledProcessError: CMake or the compiler fails; they have said why.
    """
    name, version, metadata = _metadata()
    python = f"cp{sys.version_info.major}{sys.version_info.minor}"
    tag = f"{python}-{python}-{sysconfig.get_platform().replace('-', '_').replace('.', '_')}"
    wheel = f"{name}-{version}-{tag}.whl"
    info = f"{name}-{version}.dist-info"
    build = ROOT / "build" / f"wheel-{python}"  # kept, so that the next one compiles only what has changed
    with tempfile.TemporaryDirectory() as folder:
        tree = pathlib.Path(folder)
        parts = [f"-DFCL_ARTIC_BUILD_{part}=OFF" for part in ("TESTS", "BENCH", "APP", "EXAMPLES", "VERIFIER")]
        subprocess.run(["cmake", "-S", ROOT, "-B", build, "-DCMAKE_BUILD_TYPE=Release", "-DFCL_ARTIC_WHEEL=ON",
                        f"-DPython_EXECUTABLE={sys.executable}", *parts], check=True)
        jobs = os.environ.get("CMAKE_BUILD_PARALLEL_LEVEL", str(os.cpu_count()))
        subprocess.run(["cmake", "--build", build, "--parallel", jobs, "--target", "fcl_artic_python"], check=True)
        subprocess.run(["cmake", "--install", build, "--strip", "--prefix", tree, "--component", "python"], check=True)
        texts = {f"{info}/METADATA": metadata, f"{info}/LICENSE": (ROOT / "LICENSE").read_text(),
                 f"{info}/WHEEL": f"Wheel-Version: 1.0\nGenerator: fcl_artic\nRoot-Is-Purelib: false\nTag: {tag}\n"}
        files = {str(path.relative_to(tree)): path.read_bytes() for path in sorted(tree.rglob("*")) if path.is_file()}
        files.update((path, text.encode()) for path, text in texts.items())
    record = ""
    with zipfile.ZipFile(pathlib.Path(wheel_directory, wheel), "w", zipfile.ZIP_DEFLATED) as archive:
        for path, data in files.items():
            archive.writestr(path, data)
            digest = base64.urlsafe_b64encode(hashlib.sha256(data).digest()).rstrip(b"=").decode()
            record += f"{path},sha256={digest},{len(data)}\n"
        archive.writestr(f"{info}/RECORD", record + f"{info}/RECORD,,\n")
    return wheel


def build_sdist(sdist_directory, config_settings=None):
    """Packs the files that git tracks, and returns the archive's name.

    @raises subprocess.CalledProcessError: this is no git repository.
    """
    name, version, metadata = _metadata()
    tracked = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, check=True, capture_output=True, text=True).stdout
    archive = f"{name}-{version}.tar.gz"
    with tarfile.open(pathlib.Path(sdist_directory, archive), "w:gz") as tar, tempfile.TemporaryDirectory() as folder:
        for path in tracked.split("\0")[:-1]:
            tar.add(ROOT / path, f"{name}-{version}/{path}")
        info = pathlib.Path(folder, "PKG-INFO")
        info.write_text(metadata)
        tar.add(info, f"{name}-{version}/PKG-INFO")
    return archive
