"""Unpack the students' zip as students do."""

import shutil
import subprocess
import zipfile

from grader.authoring.bundle import FOLDER


def unpacked(path, folder):
    """Unpack the zip as students do; return the folder that it unpacks to."""
    if unzip := shutil.which('unzip'):
        subprocess.run([unzip, '-q', path, '-d', folder], check=True)
    else:
        with zipfile.ZipFile(path) as box:
            box.extractall(folder)
        (folder / FOLDER / 'course').chmod(0o755)
    return folder / FOLDER
