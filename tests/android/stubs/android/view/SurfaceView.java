package android.view;

import android.content.Context;
import android.util.AttributeSet;

public class SurfaceView extends View {
    /** Of the stand-in: what the view was given to call. */
    public SurfaceHolder.Callback callback;

    public SurfaceView(Context context) {
        this(context, null);
    }

    public SurfaceView(Context context, AttributeSet attributes) {
        super(context);
    }

    public SurfaceHolder getHolder() {
        return new SurfaceHolder() {
            @Override public Surface getSurface() {
                return null;
            }

            @Override public void addCallback(SurfaceHolder.Callback given) {
                callback = given;
            }
        };
    }
}
