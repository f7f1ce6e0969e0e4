# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The MCAP files of a recording: one file, or the folder of a bag."""

import re
from pathlib import Path

import yaml


class BagError(ValueError):
    """A path that names no recording; the message says what is there instead."""


def mcap_files(path: str | Path) -> list[Path]:
    """Return the MCAP files of a recording in order.

    Parameters
    ----------
    path : an MCAP file, finished or not (``*.mcap.active``), or the folder of a bag of MCAP files.

    Raises
    ------
    BagError
        There is no such recording, or one in another format.
    """
    path = Path(path)
    if path.is_file():
        return [path]
    if not path.is_dir():
        raise BagError(f"{path}: no such file or folder")
    index = path / "metadata.yaml"
    files = sorted([*path.glob("*.mcap"), *path.glob("*.mcap.active")], key=_by_number)
    if index.is_file():
        try:
            listed = yaml.safe_load(index.read_text())["rosbag2_bagfile_information"]["relative_file_paths"]
            named = [path / str(name) for name in listed]
        except (yaml.YAMLError, KeyError, TypeError, UnicodeDecodeError):
            raise BagError(f"{index}: not the metadata of a bag") from None
        # What a killed recorder was still writing, or had no time to list, comes last.
        files = named + [file for file in files if file.name.endswith(".active") or file.stem.startswith(f"{path.name}_") and file not in named]
    unusable = [file.name for file in files if not file.is_file() or ".mcap" not in file.name or file.suffix == ".zstd"]
    if unusable or not files:
        raise BagError(f"{path}: expected uncompressed .mcap files, {'cannot use ' + ', '.join(unusable) if unusable else 'found none'}")
    return files


def _by_number(file: Path) -> tuple:
    """Order ``run_10.mcap`` after ``run_9.mcap``."""
    return tuple(int(part) if part.isdigit() else part for part in re.split(r"(\d+)", file.name))
