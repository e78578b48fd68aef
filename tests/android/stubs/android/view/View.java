package android.view;

import android.content.Context;

public class View {
    private final Context context;

    public View(Context context) {
        this.context = context;
    }

    public final Context getContext() {
        return context == null ? new Context() : context;
    }

    public boolean onTouchEvent(MotionEvent event) {
        return false;
    }

    public final int getWidth() {
        return 320;
    }

    public final int getHeight() {
        return 240;
    }

    public boolean performClick() {
        return false;
    }

    protected void onAttachedToWindow() {
    }

    protected void onDetachedFromWindow() {
    }
}
