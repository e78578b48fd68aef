// Sums over the 256 threads of a workgroup. A sum that overflows stays at the largest number.
shared uint scan_sums[256];

uint added(uint a, uint b) { return a + b < a ? 0xffffffffu : a + b; }

// Returns the sum over the threads before this one, and the sum over all.
uint sum_before(uint own, out uint all_threads)
{
    const uint thread = gl_LocalInvocationIndex;
    scan_sums[thread] = own;
    barrier();
    for (uint apart = 1u; apart < 256u; apart *= 2u) {
        const uint other = thread >= apart ? scan_sums[thread - apart] : 0u;
        barrier();
        scan_sums[thread] = added(scan_sums[thread], other);
        barrier();
    }
    all_threads = scan_sums[255];
    const uint before = thread > 0u ? scan_sums[thread - 1u] : 0u;
    barrier();
    return before;
}
