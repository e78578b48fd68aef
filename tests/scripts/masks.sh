#!/bin/sh
# Tests `fixsplat fit` with masks. Pixels of photographs that a mask ignores must have no influence.
. tests/scripts/lib/check.sh
. tests/scripts/lib/command.sh
. "$root/tests/scripts/lib/photos.sh"

have perl || { skip "masks" "no perl here"; finish; exit; }

# ---- Photographs and masks -------------------------------------------------------------------------------------------

make_photographs 12
"$fixsplat" render knot.ply --cameras set/sparse/0 --view all -o set/images/%02d.ppm
for i in 00 01 02 03 04 05 06 07 08 09 10 11; do mv set/images/$i.ppm set/images/$i.png; done

shapes() {
    mkdir -p "$1"
    perl -e 'my ($folder, $kind) = @ARGV;
        for my $i (0 .. 11) {
            open(my $f, ">:raw", sprintf("%s/%02d.png", $folder, $i)) or die;
            print $f "P6\n64 48\n255\n";
            for my $p (0 .. 64 * 48 - 1) {
                my ($x, $y) = ($p % 64 - 20 - 2 * $i, int($p / 64) - 24);
                my $in = $x * $x + $y * $y < 150;
                $in = $kind eq "none" ? 0 : $kind eq "inverse" ? !$in : $in;
                print $f $in ? "\0\0\0" : "\xff\xff\xff";
            }
        }' "$1" "$2"
}
shapes discs disc
shapes inverse inverse
shapes white none

change() {
    mkdir -p "$1"/images && cp -r set/sparse "$1"
    for i in 00 01 02 03 04 05 06 07 08 09 10 11; do
        perl -e 'my ($from, $mask, $to, $code) = @ARGV;
            local $/;
            sub bytes { open(my $f, "<:raw", $_[0]) or die; my $all = <$f>; $all =~ s/^(P6\s+\d+\s+\d+\s+\d+\s)//; ($1, $all) }
            my ($head, $pixels) = bytes($from);
            my (undef, $counts) = bytes($mask);
            for my $i (0 .. length($pixels) - 1) {
                next if ord substr($counts, $i, 1);
                local $_ = ord substr($pixels, $i, 1);
                substr($pixels, $i, 1) = chr(eval $code);
            }
            open(my $f, ">:raw", $to) or die;
            print $f $head, $pixels;' set/images/$i.png discs/$i.png "$1"/images/$i.png "$2"
    done
}
change noise '($i * 7919 + $_) % 256'
change dark 'int($_ / 4)'

# ---- Fits ------------------------------------------------------------------------------------------------------------

fit='--steps 150 --max-gaussians 1500 --quiet'
check "no masks" "$fixsplat" fit set $fit -o plain.fxs --threads 1
check "masks that ignore nothing" "$fixsplat" fit set $fit -o white.fxs --masks white
check "masks that ignore nothing: the same file" cmp plain.fxs white.fxs
check "masks" "$fixsplat" fit set $fit -o discs.fxs --masks discs --threads 1
check "masks: another file" [ "$(cmp -s plain.fxs discs.fxs; echo $?)" = 1 ]
check "masks, 2 threads, plain C" "$fixsplat" fit set $fit -o again.fxs --masks discs --threads 2 --cpu c
check "masks, 2 threads, plain C: the same file" cmp discs.fxs again.fxs
check "noise where nothing counts" "$fixsplat" fit noise $fit -o noise.fxs --masks discs
check "noise where nothing counts: the same file" cmp discs.fxs noise.fxs
check "--invert-masks" "$fixsplat" fit set $fit -o inverse.fxs --masks inverse --invert-masks
check "--invert-masks: the same file" cmp discs.fxs inverse.fxs
check "saved on the way" "$fixsplat" fit set $fit -o part.fxs --masks discs --save-every 60
check "resumed" "$fixsplat" fit set $fit -o resumed.fxs --masks discs --resume part.fxs.fit
check "resumed: the same file" cmp discs.fxs resumed.fxs
fails "resumed without masks" 1 "part.fxs.fit: a fit of other photographs" fit set $fit -o x.fxs --resume part.fxs.fit

cp -r set found && cp -r discs found/masks
check "the folder masks beside images" "$fixsplat" fit found $fit -o found.fxs
check "the folder masks beside images: the same file" cmp discs.fxs found.fxs
check "--masks none" "$fixsplat" fit found $fit -o none.fxs --masks none
check "--masks none: the file without" cmp plain.fxs none.fxs
mv found/masks/00.png found/masks/00.png.png && rm found/masks/03.png found/masks/04.png
"$fixsplat" fit found --steps 1 -o x.fxs >logs/out 2>logs/err
check "what there is of masks is said" equal "$(grep -c -e '^fixsplat: found: masks of 10 photographs$' \
    -e '^fixsplat: found: no mask of 2 photographs, of which all is used$' \
    -e '^fixsplat: found: 1[0-9]\.[0-9] % of the pixels are ignored$' logs/err)" 3

# ---- Metrics ---------------------------------------------------------------------------------------------------------

"$fixsplat" fit set --measure discs.fxs --hold-out 4 --masks discs --compare one --quiet >one.txt
"$fixsplat" fit noise --measure discs.fxs --hold-out 4 --masks discs --quiet >two.txt
"$fixsplat" fit noise --measure discs.fxs --hold-out 4 --quiet >all.txt
check "--measure: over the pixels that count" cmp one.txt two.txt
check "--measure: of all it is another number" [ "$(cmp -s one.txt all.txt; echo $?)" = 1 ]
"$fixsplat" fit dark --measure discs.fxs --hold-out 4 --compare two --quiet >logs/out
check "--compare: what is ignored is dark" cmp one/0001_04.png two/0001_04.png

mkdir fitted && cp discs/0[1-9].png fitted
"$fixsplat" fit noise --measure discs.fxs --hold-out 20 --masks fitted --quiet >one.txt
"$fixsplat" fit noise --measure discs.fxs --hold-out 20 --masks none --quiet >two.txt
check "--measure: no mask of what is measured" cmp one.txt two.txt

# ---- Errors ----------------------------------------------------------------------------------------------------------

cp -r discs small && printf 'P6\n2 1\n255\n123456' >small/05.png
fails "a mask of another size" 1 "^fixsplat: small/05.png: 2 x 1 pixels, its photograph set/images/05.png has 64 x 48" \
    fit set $fit -o x.fxs --masks small
"$fixsplat" fit set --steps 1 -o x.fxs --masks small --skip-bad >logs/out 2>logs/err
check "--skip-bad leaves its photograph out" grep -q '^fixsplat: left out: small/05.png: 2 x 1 pixels' logs/err
check "--skip-bad: it is counted" grep -q '^fixsplat: set: photographs left out: 1, taken: 11$' logs/err
fails "no such folder" 1 "^fixsplat: nowhere: no such folder of masks$" fit set $fit -o x.fxs --masks nowhere
mkdir empty
fails "no mask in it" 1 "^fixsplat: empty: it has a mask of none of the photographs; that of IMAGE.jpg is IMAGE.jpg.png or" \
    fit set $fit -o x.fxs --masks empty
fails "everything is ignored" 1 "all pixels of all photographs to fit are ignored; are the masks inverse?" \
    fit set $fit -o x.fxs --masks white --invert-masks
fails "--alpha with another word" 2 "--alpha" fit set $fit -o x.fxs --alpha drop
check "--alpha ignore of opaque photographs" "$fixsplat" fit set $fit -o opaque.fxs --alpha ignore
check "--alpha ignore of opaque photographs: the same file" cmp plain.fxs opaque.fxs
finish
