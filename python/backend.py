"""backend.py: makes the wheel, with the standard library alone, so that pip needs no network for it."""
import base64
import glob
import hashlib
import os
import re
import shutil
import subprocess
import sys
import tempfile
import zipfile

HERE = os.path.dirname(os.path.abspath(__file__))


def make_package(folder):
    """Puts the package, with its generated module, into a folder."""
    os.makedirs(folder, exist_ok=True)
    for source in glob.glob(os.path.join(HERE, 'src', 'palpate', '*.py')):
        shutil.copyfile(source, os.path.join(folder, os.path.basename(source)))
    subprocess.run([sys.executable, os.path.join(HERE, 'generate.py'), os.path.join(folder, 'c.py')], check=True)


def digest(data):
    return base64.urlsafe_b64encode(hashlib.sha256(data).digest()).rstrip(b'=').decode()


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    files = {}
    with tempfile.TemporaryDirectory() as folder:
        make_package(folder)
        for name in sorted(os.listdir(folder)):
            with open(os.path.join(folder, name), 'rb') as file:
                files['palpate/' + name] = file.read()
    version = re.search(rb"^VERSION = '(.*)'", files['palpate/c.py'], re.M)[1].decode()
    info = f'palpate-{version}.dist-info'
    files[f'{info}/METADATA'] = (
        f'Metadata-Version: 2.1\nName: palpate\nVersion: {version}\nSummary: Models of soft tissue by the C library palpate\n'
        'License: MIT\nRequires-Python: >=3.9\nRequires-Dist: numpy\n').encode()
    files[f'{info}/WHEEL'] = b'Wheel-Version: 1.0\nGenerator: palpate\nRoot-Is-Purelib: true\nTag: py3-none-any\n'
    record = ''.join(f'{name},sha256={digest(data)},{len(data)}\n' for name, data in files.items())
    files[f'{info}/RECORD'] = (record + f'{info}/RECORD,,\n').encode()
    wheel = f'palpate-{version}-py3-none-any.whl'
    with zipfile.ZipFile(os.path.join(wheel_directory, wheel), 'w', zipfile.ZIP_DEFLATED) as archive:
        for name, data in files.items():
            archive.writestr(zipfile.ZipInfo(name, (1980, 1, 1, 0, 0, 0)), data)
    return wheel


if __name__ == '__main__':  # python3 backend.py FOLDER: the package to be imported from there
    make_package(sys.argv[1])
