#!/usr/bin/env bash
# Installs the browser in which the tests open the page of a report: Debian's chromium, where there is apt and the right
# to use it.  What cannot be had is said, and the tests are skipped by name: this never fails.
if command -v chromium >/dev/null || command -v chromium-browser >/dev/null; then exit 0; fi
if ! command -v apt-get >/dev/null || [ "$(id -u)" != 0 ]; then
    echo "browser: no apt as root, chromium is left out: its tests are skipped" >&2
    exit 0
fi
export DEBIAN_FRONTEND=noninteractive
log=$(mktemp)
if ! { timeout 900 apt-get update && timeout 900 apt-get install -y --no-install-recommends chromium; } >"$log" 2>&1; then
    tail -n 3 "$log" >&2
    echo "browser: chromium cannot be had: its tests are skipped" >&2
fi
rm -f "$log"
exit 0
