#!/bin/sh
# unity_from_debian.sh FOLDER
# Takes the unmodified Unity sources out of the Debian source package ntpsec (tests/unity, licence
# Expat). Uses the mirrors this machine's apt knows; needs no root and leaves /etc and /var alone.
set -eu
folder=$1
mkdir -p "$folder"
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
mkdir -p "$scratch/sources" "$scratch/lists/partial" "$scratch/cache/archives/partial"

# The machine's binary sources of Debian or Ubuntu, asked for source packages instead. Others, such
# as a vendor's own, would only make the update slow or fail.
for list in /etc/apt/sources.list.d/*.sources; do
    [ -f "$list" ] || continue
    grep -v '^#' "$list" |
        awk 'BEGIN { RS = ""; ORS = "\n\n" } /URIs:[^\n]*\/(debian|ubuntu)\/?(\n|$)/' |
        sed 's/^Types:.*/Types: deb-src/' >"$scratch/sources/$(basename "$list")"
done
cat /etc/apt/sources.list /etc/apt/sources.list.d/*.list 2>/dev/null |
    sed -nE 's#^deb +((\[[^]]*\] +)?[^ ]*/(debian|ubuntu)/? .*)#deb-src \1#p' |
    sort -u >"$scratch/sources/classic.list"

apt() {
    apt-get -qq -o Dir::Etc::sourcelist=/dev/null -o Dir::Etc::sourceparts="$scratch/sources" \
        -o Dir::State::lists="$scratch/lists" -o Dir::Cache="$scratch/cache" \
        -o APT::Sandbox::User= "$@"
}
apt update
cd "$scratch"
apt source --download-only --tar-only ntpsec
tar -xf ntpsec_*.orig.tar.* -C "$folder" --strip-components=3 --wildcards \
    '*/tests/unity/unity.c' '*/tests/unity/unity.h' '*/tests/unity/unity_internals.h'
