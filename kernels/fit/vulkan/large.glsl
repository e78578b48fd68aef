// A splat of more tiles is listed as large, and a workgroup works on it.
const uint FEW_TILES = 16u;
