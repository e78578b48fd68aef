package org.fixsplat;

/** The natives of stand_in.c and counted.c. */
final class StandIn {
    static final int NO_VULKAN = 0, NO_COMPUTE = 1, NO_EGL = 2, OUT_OF_DATE = 3, SURFACE_LOST = 4, DEVICE_LOST = 5;

    static native long newWindow();

    static native void resize(long window, int width, int height);

    /** Writes the size of the picture, how many were shown, references, and whether a surface uses the window. */
    static native void look(long window, long[] to);

    static native int[] pixels(long window);

    static native void fail(int which, int count);

    static native int globalReferences();

    static native long blocks();
}
