#!/usr/bin/env python3
"""Makes the extension's archive: the add-on with the wheels of the module photonvdb that it is given, or that it builds for this machine.

    python build.py [WHEEL.whl ...] [-o DIRECTORY]

Blender takes the wheel that fits its own platform; one archive may have several, and names their platforms in its manifest.
"""

import argparse
import pathlib
import re
import subprocess
import sys
import tempfile
import zipfile

HERE = pathlib.Path(__file__).resolve().parent

#: What Blender calls the platforms of wheels.
PLATFORMS = {
    r"(many|musl)?linux.*_x86_64": "linux-x64",
    r"(many|musl)?linux.*_aarch64": "linux-arm64",
    r"macosx_.*_x86_64": "macos-x64",
    r"macosx_.*_arm64": "macos-arm64",
    r"win_amd64": "windows-x64",
    r"win_arm64": "windows-arm64",
}


def platform_of(wheel):
    """Blender's name of the platform of a wheel, by the last part of its file name."""
    tag = wheel.stem.rsplit("-", 1)[-1]
    for pattern, name in PLATFORMS.items():
        if re.fullmatch(pattern, tag):
            return name
    raise SystemExit(f"{wheel.name}: Blender runs on no {tag}")


def build_wheel(directory):
    """Builds the wheel of the module for this machine, which needs Rust."""
    module = HERE.parent / "python"
    subprocess.run([sys.executable, "-m", "pip", "wheel", "--no-deps", "-w", directory, module], check=True)
    return list(pathlib.Path(directory).glob("*.whl"))


def manifest(wheels):
    """The manifest, with platforms and wheels filled in."""
    text = (HERE / "blender_manifest.toml").read_text()
    platforms = sorted({platform_of(wheel) for wheel in wheels})
    listed = ", ".join(f'"./wheels/{wheel.name}"' for wheel in wheels)
    named = ", ".join(f'"{platform}"' for platform in platforms)
    return text.replace("wheels = []", f"platforms = [{named}]\nwheels = [{listed}]")


def write_archive(wheels, directory):
    """Writes the archive, and returns its path."""
    text = manifest(wheels)
    version = re.search(r'^version = "(.*)"', text, re.MULTILINE)[1]
    path = directory / f"photonvdb-{version}.zip"
    directory.mkdir(parents=True, exist_ok=True)
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("blender_manifest.toml", text)
        for source in sorted(HERE.glob("*.py")):
            if source.name != pathlib.Path(__file__).name:
                archive.write(source, source.name)
        archive.write(HERE / "README.md", "README.md")
        for wheel in wheels:
            archive.write(wheel, f"wheels/{wheel.name}", zipfile.ZIP_STORED)
    return path


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("wheels", nargs="*", type=pathlib.Path, metavar="WHEEL.whl")
    parser.add_argument("-o", "--output", type=pathlib.Path, default=HERE / "dist", metavar="DIRECTORY")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as directory:
        print(write_archive(arguments.wheels or build_wheel(directory), arguments.output))


if __name__ == "__main__":
    main()
