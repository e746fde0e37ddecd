#!/bin/sh
# Fetches the source package of SUNDIALS through apt and unpacks it, leaving the system as it is.
#
#   sundials_source.sh DIRECTORY
#
# apt reads a private configuration inside DIRECTORY: the system's own entries, deb822 (.sources) and one-line (.list),
# with `deb` turned into `deb-src`. Keys, mirrors, suites and proxies stay the system's. No root needed.
# On success DIRECTORY/tree holds the patched sources. Exit 1, with the reason on stderr, where there are none.
#
# POLHODE_APT_DIRECTORY names another directory than /etc/apt to take the entries from.
set -eu

directory=$1
entries=${POLHODE_APT_DIRECTORY:-/etc/apt}

fail() {
    echo "$1" >&2
    exit 1
}

command -v apt-get >/dev/null || fail "no apt-get on this system"
mkdir -p "$directory"
directory=$(cd "$directory" && pwd)
private=$directory/apt
rm -rf "$private" "$directory/tree"
mkdir -p "$private/parts" "$private/lists/partial" "$private/cache/archives/partial"
trap 'rm -rf "$private"' EXIT

# one-line entries: `deb [options] URI suite component..`; what follows the type is kept
for file in "$entries/sources.list" "$entries"/sources.list.d/*.list; do
    [ -r "$file" ] || continue
    sed -n -E 's/^[[:space:]]*deb(-src)?[[:space:]]+/deb-src /p' "$file"
done | sort -u >"$private/parts/polhode.list"

# deb822 stanzas: only the field `Types` changes, names of fields in any case
number=0
for file in "$entries"/sources.list.d/*.sources; do
    [ -r "$file" ] || continue
    number=$((number + 1))
    sed -E 's/^[Tt][Yy][Pp][Ee][Ss][[:space:]]*:.*/Types: deb-src/' "$file" >"$private/parts/$number.sources"
done
[ -s "$private/parts/polhode.list" ] || [ "$number" -gt 0 ] || fail "no package sources under $entries"

# hooks after an update belong to the system's own lists
cat >"$private/configuration" <<END
Dir::Etc::sourcelist "/dev/null";
Dir::Etc::sourceparts "$private/parts";
Dir::State::lists "$private/lists";
Dir::Cache "$private/cache";
Acquire::Languages "none";
APT::Sandbox::User "$(id -un)";
#clear APT::Update::Pre-Invoke;
#clear APT::Update::Post-Invoke;
#clear APT::Update::Post-Invoke-Success;
END

# a repository without sources is no fault as long as another one has the package
apt-get -q -c "$private/configuration" update >"$private/log" 2>&1 || true
cd "$directory"
rm -f sundials_*
apt-get -q -c "$private/configuration" source --download-only sundials >>"$private/log" 2>&1 || {
    grep '^[EW]:' "$private/log" | tail -n 3 >&2
    fail "apt has no source package of SUNDIALS"
}

if command -v dpkg-source >/dev/null; then
    # apt has verified the files against the signed index already
    dpkg-source --no-check -q -x sundials_*.dsc tree >"$private/log" 2>&1 || fail "$(tail -n 1 "$private/log")"
else
    mkdir tree
    tar -xf sundials_*.orig.tar.* -C tree --strip-components=1 || fail "tar cannot unpack the source package"
fi
