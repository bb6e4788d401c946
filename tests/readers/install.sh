#!/usr/bin/env bash
# Installs the readers of DXF that the tests ask: Debian's packages where there is apt and the right to use it, packages
# of npm where there is npm, of Python where there is pip; what is a library for C++ is built into a program that asks it.
# What cannot be had is said and left out, and its tests are skipped by name: this never fails.
cd "$(dirname "$0")"

say() { echo "readers: $*" >&2; }

quietly() {
    local log
    log=$(mktemp)
    if timeout 900 "$@" >"$log" 2>&1; then rm -f "$log"; return 0; fi
    tail -n 3 "$log" >&2
    rm -f "$log"
    return 1
}

debian() {  # program or file that shows that it is there, packages
    local sign=$1
    shift
    if command -v "$sign" >/dev/null 2>&1 || [ -e "$sign" ]; then return; fi
    if ! command -v apt-get >/dev/null || [ "$(id -u)" != 0 ]; then say "no apt as root: $1 is left out"; return; fi
    export DEBIAN_FRONTEND=noninteractive
    if [ -z "$updated" ]; then quietly apt-get update; updated=yes; fi
    quietly apt-get install -y --no-install-recommends "$@" || say "$1 cannot be had: its tests are skipped"
}

updated=
debian ogr2ogr gdal-bin
debian librecad librecad
debian /usr/share/inkscape/extensions/dxf_input.py inkscape
debian /usr/lib/python3/dist-packages/lxml python3-lxml
debian /usr/lib/python3/dist-packages/numpy python3-numpy
debian /usr/lib/python3/dist-packages/cssselect python3-cssselect
debian freecadcmd freecad-python3
debian openscad openscad
debian dxf2gcode dxf2gcode
debian bCNC bcnc
debian dia dia
debian /usr/include/dxflib/dl_dxf.h libdxflib-dev
debian /usr/include/dime/Model.h libdime-dev

built() {  # library, header that shows that it is there, more for the compiler
    local name=$1 sign=$2
    shift 2
    if [ build/"$name" -nt programs/"$name".cpp ]; then return; fi
    if [ ! -e "$sign" ] || ! command -v g++ >/dev/null; then say "$name cannot be built: its tests are skipped"; return; fi
    mkdir -p build
    quietly g++ -O1 -w -o build/"$name" programs/"$name".cpp "$@" || say "$name does not build: its tests are skipped"
}

built dxflib /usr/include/dxflib/dl_dxf.h -I/usr/include/dxflib -ldxflib
built dime /usr/include/dime/Model.h -ldime

if [ ! -d python_modules/dxfgrabber ]; then
    quietly python3 -m pip install --quiet --disable-pip-version-check --no-deps --only-binary :all: \
        --target python_modules -r python.txt || say "pip gives nothing: the tests of its readers are skipped"
fi
debian pdftocairo poppler-utils

if command -v npm >/dev/null && command -v node >/dev/null; then
    if ! cmp -s package-lock.json node_modules/.installed; then
        if quietly npm ci --ignore-scripts --no-audit --no-fund; then cp package-lock.json node_modules/.installed
        else say "npm gives nothing: the tests of its readers are skipped"; fi
    fi
else
    say "no npm: the tests of its readers are skipped"
fi
exit 0
