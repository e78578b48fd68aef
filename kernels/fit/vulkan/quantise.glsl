// The numbers of quantisation: those of the scene, and those of a chunk of 256 Gaussians.
fxs_fit_grid grid_of()
{
    const int n[GRID_NUMBERS] = order.grid;
    return fxs_fit_grid(n[0], int[3](n[1], n[2], n[3]), n[4], n[5], n[6], int[3](n[7], n[8], n[9]), n[10]);
}

float of_chunk(uint i, uint k) { return uintBitsToFloat(gaussians[order.at_chunks + i / 256u * 29u + k]); }
float[3] three_of(uint i, uint k) { return float[3](of_chunk(i, k), of_chunk(i, k + 1u), of_chunk(i, k + 2u)); }

fxs_fit_chunk chunk_of(uint i)
{
    fxs_fit_chunk c;
    c.low = three_of(i, 0u);
    c.step = three_of(i, 3u);
    c.inverse = three_of(i, 6u);
    c.scale = of_chunk(i, 9u);
    c.scale_step = of_chunk(i, 10u);
    c.scale_inverse = of_chunk(i, 11u);
    c.colour = three_of(i, 12u);
    c.colour_step = three_of(i, 15u);
    c.colour_inverse = three_of(i, 18u);
    c.sh_step = three_of(i, 21u);
    c.sh_inverse = three_of(i, 24u);
    c.opacity_range = of_chunk(i, 27u);
    c.opacity_inverse = of_chunk(i, 28u);
    return c;
}
