package android.view;

/** A stand-in: a window of libandroid's stand-in, by its number. */
public class Surface {
    public final long window;

    public Surface(long window) {
        this.window = window;
    }
}
