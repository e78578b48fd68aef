# Rules that run benchmarks.

peers: web ## measure the page beside other viewers in Chromium (npm, some minutes); ROUNDS=3
	B=$(B) SCENES=$(SCENES) sh tools/scripts/peers.sh $(or $(ROUNDS),3)

bench: all $(B)/tests/test_quality ## measure and write the tables of docs/measured.md
	SCENES=$(SCENES) B=$(B) sh tools/scripts/bench.sh

plot: ## draw docs/*.svg from the tables of docs/measured.md
	@for plot in sizes growth levels budgets times; do \
	    awk -v plot=$$plot -f tools/scripts/plot.awk docs/measured.md >docs/$$plot.svg.new && \
	        mv docs/$$plot.svg.new docs/$$plot.svg || { rm -f docs/$$plot.svg.new; exit 1; }; done

size: all ## code size of each part
	@sh tools/scripts/size.sh $(B)
