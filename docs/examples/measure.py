"""Prints PSNR, SSIM and LPIPS of a scene of another program, for each held-out photograph.

    python3 measure.py output/garden garden/images      # Inria: the output folder, and the photographs
    python3 measure.py ckpt_29999_rank0.pt garden       # gsplat: a checkpoint, and a COLMAP folder (needs torch)
    python3 measure.py garden.ply garden                # any scene, and photographs with cameras for `fixsplat fit`

A checkpoint of gsplat must have the coordinates of the cameras: train it with --no-normalize-world-space. LPIPS needs
torch and lpips (pip install torch lpips).
"""
import argparse
import os
import sys
import tempfile
from pathlib import Path

import fixsplat


def torch_or_none():
    try:
        import torch
        return torch
    except ImportError:
        return None


def read_gsplat(path):
    torch = torch_or_none()
    if torch is None:
        sys.exit(f"{path}: a checkpoint of gsplat needs torch: pip install torch, or export a .ply")
    s = torch.load(path, map_location="cpu", weights_only=True)["splats"]
    sh = torch.cat([s["sh0"], s["shN"]], 1)
    arrays = [s["means"], s["scales"], s["quats"], s["opacities"], sh]
    return fixsplat.Scene.from_arrays(*(a.detach().numpy() for a in arrays))


def read_inria(folder, photos, linked):
    """Returns the scene of the last iteration. `linked` becomes a folder with cameras.json beside the photographs."""
    scenes = sorted(folder.glob("point_cloud/iteration_*/point_cloud.ply"), key=lambda p: int(p.parent.name[10:]))
    if not scenes or not (folder / "cameras.json").exists():
        sys.exit(f"{folder}: expected point_cloud/iteration_N/point_cloud.ply and cameras.json")
    os.symlink((folder / "cameras.json").resolve(), linked / "cameras.json")
    os.symlink((photos / "images" if (photos / "images").is_dir() else photos).resolve(), linked / "images")
    return fixsplat.load(scenes[-1])


def lpips_or_none(net):
    """Returns a function that gives the LPIPS of two uint8 arrays, or None without torch and lpips."""
    torch = torch_or_none()
    try:
        import lpips
    except ImportError:
        return None
    model = lpips.LPIPS(net=net, verbose=False)

    def measure(*pictures):
        a, b = (torch.tensor(p[..., :3]).permute(2, 0, 1)[None] / 255 for p in pictures)
        with torch.no_grad():
            return model(a, b, normalize=True).item()      # normalize: from 0..1 to the -1..1 of the network
    return measure


parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("scene", type=Path)
parser.add_argument("photos", type=Path)
parser.add_argument("--hold-out", type=int, default=8, help="every N-th photograph by name was held out (default 8)")
parser.add_argument("--resolution", type=int, default=1600, help="longest side, pixels (default 1600)")
parser.add_argument("--white", action="store_true", help="white background (default black)")
parser.add_argument("--net", default="vgg", choices=("vgg", "alex"), help="network of LPIPS (default vgg)")
given = parser.parse_args()
lpips = lpips_or_none(given.net)
sums = []


def show(metrics, picture, photograph):
    sums.append(lpips(picture, photograph) if lpips else float("nan"))
    print(f"{metrics.name:32.32} {metrics.psnr:8.4f} {metrics.ssim:8.6f} {sums[-1]:8.6f}", flush=True)


with tempfile.TemporaryDirectory() as linked:
    is_inria = given.scene.is_dir()
    scene = (read_inria(given.scene, given.photos, Path(linked)) if is_inria
             else read_gsplat(given.scene) if given.scene.suffix == ".pt" else fixsplat.load(given.scene))
    if lpips is None:
        print("no LPIPS: it needs torch and lpips (pip install torch lpips)", file=sys.stderr)
    print(f"{'photograph':32} {'PSNR, dB':>8} {'SSIM':>8} {'LPIPS':>8}")
    found = fixsplat.measure(scene, linked if is_inria else given.photos, hold_out=given.hold_out, each=show,
                             resolution=given.resolution, background=(255, 255, 255) if given.white else (0, 0, 0))
print(f"{'mean':32} {found.psnr:8.4f} {found.ssim:8.6f} {sum(sums) / len(sums):8.6f}")
