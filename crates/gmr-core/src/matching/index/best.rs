//! What a search keeps of the frames it meets.

use super::Hit;

/// The best frames met so far.
pub(super) trait Best {
    /// The hit that a frame must beat to be kept.
    fn bound(&self) -> Hit;
    /// Keeps a hit that beats the bound.
    fn offer(&mut self, hit: Hit);
    /// Puts the hits in order, [`Hit::NONE`] behind them, and says how many there are.
    fn finish(self) -> usize;
}

/// The one best frame.
pub(super) struct Nearest<'a> {
    hit: &'a mut Hit,
    start: Hit,
}

impl<'a> Nearest<'a> {
    /// Keeps the best that beats `start` in `hit`.
    pub(super) fn new(hit: &'a mut Hit, start: Hit) -> Self {
        *hit = start;
        Self { hit, start }
    }
}

impl Best for Nearest<'_> {
    #[inline(always)]
    fn bound(&self) -> Hit {
        *self.hit
    }

    #[inline(always)]
    fn offer(&mut self, hit: Hit) {
        *self.hit = hit;
    }

    fn finish(self) -> usize {
        let found = *self.hit != self.start;
        if !found {
            *self.hit = Hit::NONE;
        }
        usize::from(found)
    }
}

/// The `hits.len()` best frames: a heap with the worst on top while the search lasts, then in order.
pub(super) struct Ranked<'a> {
    hits: &'a mut [Hit],
    found: usize,
    limit: Hit,
}

impl<'a> Ranked<'a> {
    /// Keeps the best that beat `limit`.
    pub(super) fn new(hits: &'a mut [Hit], limit: Hit) -> Self {
        Self { hits, found: 0, limit }
    }

    fn rise(&mut self, mut place: usize) {
        while place > 0 {
            let above = (place - 1) / 2;
            if !self.hits[above].beats(self.hits[place]) {
                break;
            }
            self.hits.swap(above, place);
            place = above;
        }
    }

    fn sink(&mut self) {
        let mut place = 0;
        loop {
            let (left, right) = (2 * place + 1, 2 * place + 2);
            if left >= self.found {
                break;
            }
            let worse =
                if right < self.found && self.hits[left].beats(self.hits[right]) { right } else { left };
            if !self.hits[place].beats(self.hits[worse]) {
                break;
            }
            self.hits.swap(worse, place);
            place = worse;
        }
    }
}

impl Best for Ranked<'_> {
    fn bound(&self) -> Hit {
        match self.hits.first() {
            // Nothing beats this, so a search for no hits keeps none.
            None => Hit { frame: 0, cost: f32::NEG_INFINITY },
            Some(&worst) if self.found == self.hits.len() => worst,
            Some(_) => self.limit,
        }
    }

    fn offer(&mut self, hit: Hit) {
        if self.found < self.hits.len() {
            self.hits[self.found] = hit;
            self.found += 1;
            self.rise(self.found - 1);
        } else if let Some(worst) = self.hits.first_mut() {
            *worst = hit;
            self.sink();
        }
    }

    fn finish(self) -> usize {
        let (found, rest) = self.hits.split_at_mut(self.found);
        found.sort_unstable_by(|a, b| a.cost.total_cmp(&b.cost).then(a.frame.cmp(&b.frame)));
        rest.fill(Hit::NONE);
        found.len()
    }
}
