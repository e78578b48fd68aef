// Replaces the splat number in each pixel by object and Gaussian ids.
// Needs records

@group(0) @binding(0) var<uniform> frame: Frame;
@group(1) @binding(1) var<storage, read_write> memory: array<u32>;

// Finds the span (range of one object's drawn chunks) that contains the drawn chunk with index `place`.
fn span_of(place: u32) -> u32
{
    var low = 0u;
    var high = frame.spans;
    while (high - low > 1u) {
        let middle = (low + high) / 2u;
        if (memory[frame.spans_at + SPAN * middle] <= place) {
            low = middle;
        } else {
            high = middle;
        }
    }
    return frame.spans_at + SPAN * low;
}

@compute @workgroup_size(128)
fn name_pixels(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32)
{
    let pixel = (group.y * ROW_OF_GROUPS + group.x) * THREADS + thread;
    let at = frame.id + 2u * pixel;
    if (pixel >= u32(frame.size.x * frame.size.y)) {
        return;
    }
    let slot = memory[at];
    var id = vec2<u32>(NOTHING);
    if (slot != NOTHING) {
        let place = memory[frame.visible + slot / CHUNK];
        let span = span_of(place);
        var chunk = place;
        if (frame.drawn != 0u) {
            chunk = memory[frame.drawn + DRAWN * place + 2u];
        }
        id = vec2<u32>(memory[span + 4u], (chunk - memory[span + 5u]) * CHUNK + slot % CHUNK);
    }
    memory[at] = id.x;
    memory[at + 1u] = id.y;
}
