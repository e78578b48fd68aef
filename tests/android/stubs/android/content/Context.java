package android.content;

import android.content.res.AssetManager;

public class Context {
    public AssetManager getAssets() {
        return new AssetManager(".");
    }

    public Context getApplicationContext() {
        return this;
    }

    public void registerComponentCallbacks(ComponentCallbacks callbacks) {
    }

    public void unregisterComponentCallbacks(ComponentCallbacks callbacks) {
    }
}
