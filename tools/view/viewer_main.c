/* fixsplat-view: the separate program that opens the window of `fixsplat view`, with the same arguments. */
#include <fixsplat/system.h>
#include <fixsplat/internal/output.h>
#include "src/base/os_calls.h"
#include "viewer.h"
#include "tools/command/auto_backend.h"
#include "tools/command/cmd_view.h"

int main(int argc, char **argv)
{
    view_options o;
    viewer v;
    fxs_program_begin(&argc, &argv);
    check_printed_at_exit();
    int status = view_options_take(&o, argc, argv);
    if (!status)
        settle_backend(&o.frame, o.screenshot ? 1 : AUTO_PIXELS);
    if (!status)
        status = viewer_open(&v, &o.frame, o.screenshot, o.rate);
    if (status)
        return status;
    v.walk.file = o.walls;
    v.walk.height_given = o.eye_height;
    fxs_output_remove_at_signals();   /* a signal that ends the program removes its temporary files */
    while (!v.quit)
        viewer_step(&v, -1);
    viewer_close(&v);
    return v.status;
}
