/* fixsplat-view: what `fixsplat view` runs, with the same words. */
#include "viewer.h"
#include "window.h"

int main(int argc, char **argv)
{
    window_options o;
    viewer v;
    command_begin();
    int status = window_options_take(&o, argc, argv);
    if (!status)
        status = viewer_open(&v, &o.view, o.scene, o.screenshot);
    if (status)
        return status;
    while (!v.quit)
        viewer_step(&v, -1);
    viewer_close(&v);
    return EXIT_OK;
}
