#!/bin/sh
# setup.sh PACKAGE...: installs missing Debian packages, as root or by sudo.
installed=$(dpkg-query -W -f='${Status} ${Package} \n' "$@" 2>/dev/null | sed -n 's/^[a-z]* ok installed//p')
missing=
for package in "$@"; do
    case $installed in *" $package "*) ;; *) missing="$missing $package" ;; esac
done
[ -z "$missing" ] && { echo "setup: nothing is missing"; exit 0; }
command -v apt-get >/dev/null || { echo "setup: no apt-get here; install by hand:$missing" >&2; exit 1; }
root=
[ "$(id -u)" = 0 ] || root=sudo
echo "setup: installing$missing"
apt() { $root env DEBIAN_FRONTEND=noninteractive LC_ALL=C apt-get -qq -o DPkg::Lock::Timeout=300 "$@"; }
# apt-get does not wait for the lock that `apt-get update` needs, so the script tries again.
tries=0
until said=$(apt update 2>&1); do
    case $said in *"Could not get lock"*) ;; *) tries=60 ;; esac
    [ $((tries += 1)) -le 60 ] || { echo "setup: $said" >&2; exit 1; }
    sleep 5
done
apt install -y --no-install-recommends $missing >/dev/null
