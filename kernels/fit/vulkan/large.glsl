// A splat of more than FEW_TILES tiles is listed as large, and a workgroup writes its slots. A workgroup sums the
// gradients of a splat of more than SOME_TILES tiles.
const uint FEW_TILES = 16u, SOME_TILES = 32u;
