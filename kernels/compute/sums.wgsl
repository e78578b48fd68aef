// Prefix sums over the threads of a workgroup, in groups of 16 threads to save barriers.

const GROUP: u32 = 16u;

var<workgroup> sums: array<u32, 128>;
var<workgroup> group_sums: array<u32, 8>;

// Returns a + b. With `cut`, saturates at 2^32 - 1.
fn plus(a: u32, b: u32, cut: bool) -> u32
{
    return select(a + b, 0xffffffffu, cut && a + b < a);
}

// Returns the sum of `own` over the preceding threads of the workgroup. A barrier must separate two calls.
fn sum_before(thread: u32, own: u32, cut: bool) -> u32
{
    sums[thread] = own;
    workgroupBarrier();
    if (thread < THREADS / GROUP) {
        var sum = 0u;
        for (var i = 0u; i < GROUP; i += 1u) {
            sum = plus(sum, sums[GROUP * thread + i], cut);
        }
        group_sums[thread] = sum;
    }
    workgroupBarrier();
    var sum = 0u;
    for (var i = 0u; i < thread / GROUP; i += 1u) {
        sum = plus(sum, group_sums[i], cut);
    }
    for (var i = thread / GROUP * GROUP; i < thread; i += 1u) {
        sum = plus(sum, sums[i], cut);
    }
    return sum;
}

fn sum_of_all(cut: bool) -> u32
{
    var sum = 0u;
    for (var i = 0u; i < THREADS / GROUP; i += 1u) {
        sum = plus(sum, group_sums[i], cut);
    }
    return sum;
}
