#!/bin/sh
# downloads.sh FOLDER VERSION: prints the page of the packages in FOLDER: which file to take for which system, with sizes
# and SHA-256 sums. Fails if a file has no row.
set -e
cd "${1:?folder}"
version=${2:?version}
rows=0
cat <<END
<!doctype html>
<html lang="en">
<meta charset="utf-8">
<meta name="viewport" content="width=device-width">
<title>fixsplat $version: downloads</title>
<style>
body { font: 16px/1.5 sans-serif; max-width: 75em; margin: 2em auto; padding: 0 1em; color-scheme: light dark; }
td, th { text-align: left; vertical-align: top; padding: 0.3em 1em 0.3em 0; border-bottom: 1px solid #8884; }
code { font-size: 12px; overflow-wrap: anywhere; }
</style>
<h1>fixsplat $version</h1>
<p>fixsplat renders, converts and fits scenes of 3D Gaussian splatting. Take the file of your system. To check what you
downloaded: <code>sha256sum -c --ignore-missing SHA256SUMS</code>; on Windows <code>certutil -hashfile FILE SHA256</code>.
<table>
<tr><th>for<th>file<th>MB<th>SHA-256
END
while IFS='|' read -r pattern system; do
    for file in $pattern; do
        [ -e "$file" ] || continue
        rows=$((rows + 1))
        printf '<tr><td>%s<td><a href="%s">%s</a><td>%s<td><code>%s</code>\n' "$system" "$file" "$file" \
            "$(wc -c <"$file" | awk '{ printf "%.1f", $1 / 1e6 }')" "$(sha256sum <"$file" | cut -c -64)"
    done
done <<END
*-windows-x86_64.zip|Windows: unpack it, then drop a scene onto bin\fixsplat.exe
fixsplat_*.deb|Debian 12 and derivatives: the command and the viewer, with the next file
libfixsplat[0-9]*.deb|Debian: the library
libfixsplat-dev_*.deb|Debian: headers, for programs in C
python3-fixsplat_*.deb|Debian: Python
*-linux-x86_64.tar.gz|other Linux on x86-64 (glibc 2.36 or later), and NVIDIA GPUs
*-linux-aarch64.tar.gz|other Linux on 64-bit ARM
*_x86_64.whl|Python on Linux, x86-64, with CUDA: pip install FILE
*_aarch64.whl|Python on Linux, 64-bit ARM
*-win_amd64.whl|Python on Windows
fixsplat-viewer-*-npm.tgz|web pages: the viewer's element, with the next file
fixsplat-[0-9]*-npm.tgz|web pages and Node: npm install FILE
fixsplat-$version.tar.gz|sources, for all other systems
END
echo "</table>"
[ "$rows" = "$(ls | wc -l)" ] || { echo "downloads: $rows rows for the $(ls | wc -l) files in $1" >&2; exit 1; }
