(* SPDX-License-Identifier: BSD-3-Clause *)
(** * Geometry by its corners, and how far it reaches along a direction *)
From Coq Require Import Reals ZArith Lia Lra Bool List.
From FclArtic Require Import Statement Numbers Trig Frames Enclose.
Import ListNotations.
Open Scope R_scope.

Lemma norm_nonneg v : 0 <= norm v.
Proof. apply sqrt_pos. Qed.
Lemma dot_nonneg v : 0 <= dot v v.
Proof. unfold dot. nra. Qed.

Lemma cauchy v x : dot v x <= norm v * norm x.
Proof.
  unfold norm. rewrite <- sqrt_mult by apply dot_nonneg.
  eapply Rle_trans; [apply Rle_abs|]. rewrite <- sqrt_Rsqr_abs. apply sqrt_le_1_alt.
  assert (0 <= dot (cross v x) (cross v x)) by apply dot_nonneg.
  assert (E : dot v v * dot x x - Rsqr (dot v x) = dot (cross v x) (cross v x))
    by (unfold dot, cross, Rsqr; cbn; ring). lra.
Qed.

(** ** Outlines

    A convex piece as its corners and a radius. A corner is an ellipsoid around a point, with the semi-axes along those
    of the geometry: a disc, or most often the point itself. Its numbers are constant models. The outline covers a point
    if along every direction the point is no farther than some corner and the radius. A halfspace is a wall; a plane is
    one with [both] sides. *)
Record round := Round { centre : tvec; semiaxes : option tvec }.
Inductive outline :=
  | Outline (corners : list round) (radius : Z)
  | Wall (normal : numbers3) (offset : number) (both : bool).

Definition times (a v : vec) : vec := Vec (vx a * vx v) (vy a * vy v) (vz a * vz v).

Definition holds_round (c : round) (s : R) (p a : vec) : Prop :=
  holdsv (centre c) s p /\ match semiaxes c with Some m => holdsv m s a | None => a = Vec 0 0 0 end.

Definition covers (s : R) (o : outline) (x : vec) : Prop :=
  match o with
  | Outline corners radius =>
      forall v, exists c p a, In c corners /\ holds_round c s p a /\
        dot v x <= dot v p + norm (times a v) + V radius * norm v
  | Wall n d both => dot (point n) x <= real d /\ (both = true -> dot (point n) x = real d)
  end.

Definition at_point (p : tvec) : round := Round p None.

Lemma at_point_holds m s p : holdsv m s p -> holds_round (at_point m) s p (Vec 0 0 0).
Proof. intros H. split; [exact H | reflexivity]. Qed.

Definition tsub (a b : tvec) := Tvec (tm_sub (tx a) (tx b)) (tm_sub (ty a) (ty b)) (tm_sub (tz a) (tz b)).
Definition box_corners (c h : tvec) : list tvec :=
  flat_map (fun x => flat_map (fun y => map (fun z => Tvec x y z) [tm_add (tz c) (tz h); tm_sub (tz c) (tz h)])
                              [tm_add (ty c) (ty h); tm_sub (ty c) (ty h)])
           [tm_add (tx c) (tx h); tm_sub (tx c) (tx h)].

Definition half (x : number) : number := Number (mantissa x) (exponent x - 1).
Definition half3 (p : numbers3) : numbers3 := Numbers3 (half (n1 p)) (half (n2 p)) (half (n3 p)).
Definition origin_tm : tvec := Tvec tm_zero tm_zero tm_zero.

Definition of_points (ps : list tvec) : outline := Outline (map at_point ps) 0.

(** The ends of the axis of a shape of length l along z. *)
Definition upper_end (l : number) : tvec := Tvec tm_zero tm_zero (tm_number (half l)).
Definition lower_end (l : number) : tvec := Tvec tm_zero tm_zero (tm_opp (tm_number (half l))).
Definition disc (p : tvec) (r : number) : round := Round p (Some (Tvec (tm_number r) (tm_number r) tm_zero)).

Definition outlines (g : geometry) : list outline :=
  match g with
  | MeshSurface ts => map (fun t => let '(a, b, c) := t in of_points [tm_point a; tm_point b; tm_point c]) ts
  | Boxes cells => map (fun c => of_points (box_corners (tm_point (fst c)) (tm_point (snd c)))) cells
  | Box sizes => [of_points (box_corners origin_tm (tm_point (half3 sizes)))]
  | Sphere r => [Outline [at_point origin_tm] (number_up r)]
  | Capsule r l => [Outline [at_point (upper_end l); at_point (lower_end l)] (number_up r)]
  | Ellipsoid a => [Outline [Round origin_tm (Some (tm_point a))] 0]
  | Cylinder r l => [Outline [disc (upper_end l) r; disc (lower_end l) r] 0]
  | Cone r l => [Outline [at_point (upper_end l); disc (lower_end l) r] 0]
  | Hull ps => [of_points (map tm_point ps)]
  | Halfspace n d => [Wall n d false]
  | Plane n d => [Wall n d true]
  end.

Lemma real_half x : real (half x) = real x / 2.
Proof.
  unfold half, real; cbn [mantissa exponent]. unfold Z.sub. rewrite powerRZ_add, (power_opp 1), powerRZ_1 by lra. field.
Qed.

Lemma hull_farthest ps x v : in_hull ps x -> exists p, In p ps /\ dot v x <= dot v p.
Proof.
  induction 1 as [p Hp | x y l _ (p & Pp & Lp) _ (q & Pq & Lq) Hl].
  - exists p. split; [exact Hp | lra].
  - assert (E : dot v (add (scale l x) (scale (1 - l) y)) = l * dot v x + (1 - l) * dot v y)
      by (unfold dot, add, scale; cbn; ring).
    rewrite E. destruct (Rle_dec (dot v p) (dot v q)) as [L|G]; [exists q | exists p]; split; try assumption; nra.
Qed.

Lemma norm_nil v : norm (times (Vec 0 0 0) v) = 0.
Proof.
  unfold norm, times, dot; cbn [vx vy vz]. replace (_ + _ + _) with 0 by ring. apply sqrt_0.
Qed.

(** Pieces without a radius, of which some point is the farthest. *)
Lemma points_cover s ms x :
  (forall v, exists m p, In m ms /\ holdsv m s p /\ dot v x <= dot v p) -> covers s (of_points ms) x.
Proof.
  intros H v. destruct (H v) as (m & p & I & Hm & L). exists (at_point m), p, (Vec 0 0 0).
  split; [apply in_map; exact I|]. split; [apply at_point_holds; exact Hm|]. rewrite norm_nil, V_0. lra.
Qed.

Lemma hull_covers s ms ps x : Forall2 (fun m p => holdsv m s p) ms ps -> in_hull ps x -> covers s (of_points ms) x.
Proof.
  intros H Hx. apply points_cover. intros v. destruct (hull_farthest ps x v Hx) as (p & Hp & L). clear Hx.
  induction H as [|m q ms ps Hm H IH]; [destruct Hp|]. destruct Hp as [->|Hp].
  - exists m, p. split; [left; reflexivity|]. split; [exact Hm | exact L].
  - destruct (IH Hp) as (c & r & Ic & Hc & Lc). exists c, r. split; [right; exact Ic|]. split; assumption.
Qed.

(** The farther end of an interval along one axis. *)
Lemma farther_end s v x c h cm hm : holds cm s c -> holds hm s h -> Rabs (x - c) <= h ->
  exists m p, In m [tm_add cm hm; tm_sub cm hm] /\ holds m s p /\ v * x <= v * p.
Proof.
  intros Hc Hh Hx. apply abs_in in Hx. destruct (Rle_lt_dec 0 v) as [P|N].
  - exists (tm_add cm hm), (c + h). split; [cbn; auto|]. split; [apply holds_add; assumption | nra].
  - exists (tm_sub cm hm), (c - h). split; [cbn; auto|]. split; [apply holds_sub; assumption | nra].
Qed.

Lemma box_covers s cm hm c h x : holdsv cm s c -> holdsv hm s h -> in_box h (sub x c) ->
  covers s (of_points (box_corners cm hm)) x.
Proof.
  intros (C1 & C2 & C3) (H1 & H2 & H3) (B1 & B2 & B3). apply points_cover. intros v. unfold sub, add, scale in B1, B2, B3.
  cbn [vx vy vz] in B1, B2, B3.
  destruct (farther_end s (vx v) (vx x) (vx c) (vx h) _ _ C1 H1) as (m1 & p1 & I1 & P1 & L1);
    [replace (vx x - vx c) with (vx x + -1 * vx c) by ring; exact B1|].
  destruct (farther_end s (vy v) (vy x) (vy c) (vy h) _ _ C2 H2) as (m2 & p2 & I2 & P2 & L2);
    [replace (vy x - vy c) with (vy x + -1 * vy c) by ring; exact B2|].
  destruct (farther_end s (vz v) (vz x) (vz c) (vz h) _ _ C3 H3) as (m3 & p3 & I3 & P3 & L3);
    [replace (vz x - vz c) with (vz x + -1 * vz c) by ring; exact B3|].
  exists (Tvec m1 m2 m3), (Vec p1 p2 p3). split; [|split].
  - unfold box_corners. apply in_flat_map. exists m1. split; [exact I1|].
    apply in_flat_map. exists m2. split; [exact I2|]. apply in_map. exact I3.
  - repeat split; assumption.
  - unfold dot; cbn [vx vy vz]. lra.
Qed.

Lemma ball_covers s cs r rr x c : (forall v, exists m p, In m cs /\ holdsv m s p /\ dot v c <= dot v p) ->
  norm (sub x c) <= rr -> rr <= V r -> covers s (Outline (map at_point cs) r) x.
Proof.
  intros H N R v. destruct (H v) as (m & p & Im & Hm & L). exists (at_point m), p, (Vec 0 0 0).
  split; [apply in_map; exact Im|]. split; [apply at_point_holds; exact Hm|]. rewrite norm_nil.
  assert (E : dot v x = dot v c + dot v (sub x c)) by (unfold dot, sub, add, scale; cbn; ring).
  pose proof (cauchy v (sub x c)). pose proof (norm_nonneg v).
  assert (norm v * norm (sub x c) <= norm v * V r) by (apply Rmult_le_compat_l; lra). lra.
Qed.

Lemma origin_holds s : holdsv origin_tm s (Vec 0 0 0).
Proof. repeat split; apply holds_zero. Qed.

Lemma ends_hold s l : holdsv (upper_end l) s (Vec 0 0 (real l / 2)) /\ holdsv (lower_end l) s (Vec 0 0 (- (real l / 2))).
Proof.
  pose proof (holds_number s (half l)) as H. rewrite real_half in H.
  repeat split; cbn [upper_end lower_end tx ty tz vx vy vz]; try apply holds_zero; [exact H | apply holds_opp; exact H].
Qed.

(** In the plane of a disc: v.x is at most |v| r. *)
Lemma in_disc v x r : norm (Vec (vx x) (vy x) 0) <= r -> 0 <= r ->
  vx v * vx x + vy v * vy x <= norm (times (Vec r r 0) v).
Proof.
  intros N R. pose proof (cauchy (Vec (vx v) (vy v) 0) (Vec (vx x) (vy x) 0)) as C.
  assert (E : norm (times (Vec r r 0) v) = r * norm (Vec (vx v) (vy v) 0)).
  { unfold norm. replace (dot (times (Vec r r 0) v) (times (Vec r r 0) v)) with
      (r * r * dot (Vec (vx v) (vy v) 0) (Vec (vx v) (vy v) 0)) by (unfold dot, times; cbn; ring).
    rewrite sqrt_mult_alt by (apply Rmult_le_pos; exact R). rewrite sqrt_square by exact R. reflexivity. }
  rewrite E. unfold dot in C at 1. cbn [vx vy vz] in C.
  pose proof (norm_nonneg (Vec (vx v) (vy v) 0)). 
  assert (norm (Vec (vx v) (vy v) 0) * norm (Vec (vx x) (vy x) 0) <= norm (Vec (vx v) (vy v) 0) * r)
    by (apply Rmult_le_compat_l; assumption). lra.
Qed.

Lemma disc_holds s m p r : holdsv m s p -> holds_round (disc m r) s p (Vec (real r) (real r) 0).
Proof. intros H. split; [exact H|]. repeat split; try apply holds_number. apply holds_zero. Qed.

Theorem outlines_cover g x : inside g x -> exists o, In o (outlines g) /\ forall s, covers s o x.
Proof.
  destruct g as [ts | cells | sizes | r | r l | a | r l | r l | ps | n d | n d]; cbn [inside outlines].
  - intros (a & b & c & I & H). exists (of_points [tm_point a; tm_point b; tm_point c]).
    split; [apply in_map_iff; exists (a, b, c); split; [reflexivity | exact I]|]. intros s.
    eapply hull_covers; [|exact H]. repeat (apply Forall2_cons; [apply holdsv_point|]). apply Forall2_nil.
  - intros (c & h & I & H). exists (of_points (box_corners (tm_point c) (tm_point h))).
    split; [apply in_map_iff; exists (c, h); split; [reflexivity | exact I]|]. intros s.
    eapply box_covers; [apply holdsv_point | apply holdsv_point | exact H].
  - intros H. eexists. split; [left; reflexivity|]. intros s.
    apply box_covers with (c := Vec 0 0 0) (h := point (half3 sizes)); [apply origin_holds | apply holdsv_point|].
    unfold in_box, sub, add, scale, point, half3 in *; cbn [vx vy vz n1 n2 n3] in *. rewrite !real_half.
    destruct H as (H1 & H2 & H3).
    replace (vx x + -1 * 0) with (vx x) by ring. replace (vy x + -1 * 0) with (vy x) by ring.
    replace (vz x + -1 * 0) with (vz x) by ring. repeat split; unfold Rdiv; rewrite Rmult_comm; assumption || lra.
  - intros H. eexists. split; [left; reflexivity|]. intros s.
    apply (ball_covers s [origin_tm]) with (rr := real r) (c := Vec 0 0 0).
    + intros v. exists origin_tm, (Vec 0 0 0). split; [left; reflexivity|]. split; [apply origin_holds | lra].
    + replace (sub x (Vec 0 0 0)) with x; [exact H|]. destruct x. unfold sub, add, scale; cbn. f_equal; ring.
    + apply number_up_ok.
  - intros (z & Hz & H). eexists. split; [left; reflexivity|]. intros s.
    apply (ball_covers s [upper_end l; lower_end l]) with (rr := real r) (c := Vec 0 0 z); [|exact H | apply number_up_ok].
    intros v. destruct (ends_hold s l) as [U L]. destruct (Rle_lt_dec 0 (vz v)) as [P|N].
    + exists (upper_end l), (Vec 0 0 (real l / 2)). split; [left; reflexivity|]. split; [exact U|].
      unfold dot; cbn [vx vy vz]. nra.
    + exists (lower_end l), (Vec 0 0 (- (real l / 2))). split; [right; left; reflexivity|]. split; [exact L|].
      unfold dot; cbn [vx vy vz]. nra.
  - intros (u & Nu & ->). eexists. split; [left; reflexivity|]. intros s v.
    exists (Round origin_tm (Some (tm_point a))), (Vec 0 0 0), (point a).
    split; [left; reflexivity|]. split; [split; [apply origin_holds | apply holdsv_point]|]. rewrite V_0.
    pose proof (cauchy (times (point a) v) u) as C. pose proof (norm_nonneg (times (point a) v)).
    assert (norm (times (point a) v) * norm u <= norm (times (point a) v) * 1) by (apply Rmult_le_compat_l; assumption).
    replace (dot v _) with (dot (times (point a) v) u) by (unfold dot, times, point; cbn; ring).
    replace (dot v (Vec 0 0 0)) with 0 by (unfold dot; cbn; ring). lra.
  - intros (N & Hz). eexists. split; [left; reflexivity|]. intros s v. destruct (ends_hold s l) as [U L].
    assert (R : 0 <= real r) by (pose proof (norm_nonneg (Vec (vx x) (vy x) 0)); lra).
    pose proof (in_disc v x (real r) N R) as D. rewrite V_0.
    destruct (Rle_lt_dec 0 (vz v)) as [P|G].
    + exists (disc (upper_end l) r), (Vec 0 0 (real l / 2)), (Vec (real r) (real r) 0).
      split; [left; reflexivity|]. split; [apply disc_holds; exact U|]. unfold dot; cbn [vx vy vz]. nra.
    + exists (disc (lower_end l) r), (Vec 0 0 (- (real l / 2))), (Vec (real r) (real r) 0).
      split; [right; left; reflexivity|]. split; [apply disc_holds; exact L|]. unfold dot; cbn [vx vy vz]. nra.
  - intros (h & Hh & N & Hz). eexists. split; [left; reflexivity|]. intros s v. destruct (ends_hold s l) as [U L].
    rewrite V_0.
    assert (D : vx v * vx x + vy v * vy x <= (1 - h) * norm (times (Vec (real r) (real r) 0) v)).
    { pose proof (norm_nonneg (Vec (vx x) (vy x) 0)).
      pose proof (in_disc v x ((1 - h) * real r) N ltac:(lra)) as D.
      eapply Rle_trans; [exact D|]. apply Req_le. unfold norm.
      replace (dot (times (Vec ((1 - h) * real r) ((1 - h) * real r) 0) v) _) with
        ((1 - h) * (1 - h) * dot (times (Vec (real r) (real r) 0) v) (times (Vec (real r) (real r) 0) v))
        by (unfold dot, times; cbn; ring).
      rewrite sqrt_mult_alt by (apply Rmult_le_pos; lra). rewrite sqrt_square by lra. reflexivity. }
    set (n := norm (times (Vec (real r) (real r) 0) v)) in *.
    (* v.x is at most the mean, with weights h and 1 - h, of what apex and base reach *)
    assert (M : dot v x <= h * (vz v * (real l / 2)) + (1 - h) * (vz v * - (real l / 2) + n)).
    { unfold dot. rewrite Hz. nra. }
    destruct (Rle_lt_dec (vz v * - (real l / 2) + n) (vz v * (real l / 2))) as [P|G].
    + exists (at_point (upper_end l)), (Vec 0 0 (real l / 2)), (Vec 0 0 0).
      split; [left; reflexivity|]. split; [apply at_point_holds; exact U|]. rewrite norm_nil.
      unfold dot at 2; cbn [vx vy vz]. nra.
    + exists (disc (lower_end l) r), (Vec 0 0 (- (real l / 2))), (Vec (real r) (real r) 0).
      split; [right; left; reflexivity|]. split; [apply disc_holds; exact L|]. fold n.
      unfold dot at 2; cbn [vx vy vz]. nra.
  - intros H. eexists. split; [left; reflexivity|]. intros s. apply hull_covers with (ps := map point ps); [|exact H].
    clear H. induction ps as [|p ps IH]; cbn; constructor; [apply holdsv_point | exact IH].
  - intros H. eexists. split; [left; reflexivity|]. intros s. split; [exact H | discriminate].
  - intros H. eexists. split; [left; reflexivity|]. intros s. split; [lra | intros _; exact H].
Qed.

(** ** Bounds: boxes along the axes *)

Record bounds := Bounds { x0 : Z; x1 : Z; y0 : Z; y1 : Z; z0 : Z; z1 : Z }.
Definition in_bounds (b : bounds) (x : vec) : Prop :=
  V (x0 b) <= vx x <= V (x1 b) /\ V (y0 b) <= vy x <= V (y1 b) /\ V (z0 b) <= vz x <= V (z1 b).
Definition both_bounds (a b : bounds) : bounds :=
  Bounds (Z.min (x0 a) (x0 b)) (Z.max (x1 a) (x1 b)) (Z.min (y0 a) (y0 b)) (Z.max (y1 a) (y1 b))
         (Z.min (z0 a) (z0 b)) (Z.max (z1 a) (z1 b)).
Definition join_bounds (a b : option bounds) : option bounds :=
  match a, b with Some x, Some y => Some (both_bounds x y) | _, _ => None end.

Definition bounds_of_corner (c : round) : option bounds :=
  let p := centre c in
  match semiaxes c with
  | None =>
      if is_const (tx p) && is_const (ty p) && is_const (tz p) then
        Some (Bounds (c0 (tx p) - rem (tx p)) (c0 (tx p) + rem (tx p)) (c0 (ty p) - rem (ty p)) (c0 (ty p) + rem (ty p))
                     (c0 (tz p) - rem (tz p)) (c0 (tz p) + rem (tz p)))
      else None
  | Some _ => None
  end.
Fixpoint bounds_of_corners (cs : list round) : option bounds :=
  match cs with
  | [] => None
  | [c] => bounds_of_corner c
  | c :: rest => join_bounds (bounds_of_corner c) (bounds_of_corners rest)
  end.
Definition bounds_of (o : outline) : option bounds :=
  match o with Outline cs r => if Z.leb r 0 then bounds_of_corners cs else None | Wall _ _ _ => None end.

Definition bounded (b : bounds) (o : outline) : Prop := forall s x, covers s o x -> in_bounds b x.

Lemma both_bounds_ok a b x : in_bounds a x \/ in_bounds b x -> in_bounds (both_bounds a b) x.
Proof.
  unfold in_bounds, both_bounds; cbn [x0 x1 y0 y1 z0 z1].
  assert (L : forall p q, V (Z.min p q) <= V p /\ V (Z.min p q) <= V q) by (intros; split; apply V_le; lia).
  pose proof (L (x0 a) (x0 b)). pose proof (L (y0 a) (y0 b)). pose proof (L (z0 a) (z0 b)).
  pose proof (V_max (x1 a) (x1 b)). pose proof (V_max (y1 a) (y1 b)). pose proof (V_max (z1 a) (z1 b)).
  intros [(A & B & C)|(A & B & C)]; repeat split; lra.
Qed.

Lemma bounds_of_corner_ok s c b p a : bounds_of_corner c = Some b -> holds_round c s p a -> a = Vec 0 0 0 /\ in_bounds b p.
Proof.
  unfold bounds_of_corner, holds_round. destruct (semiaxes c); [discriminate|].
  destruct (is_const (tx (centre c)) && is_const (ty (centre c)) && is_const (tz (centre c))) eqn:K; [|discriminate].
  rewrite !andb_true_iff in K. destruct K as [[K1 K2] K3]. apply is_const_const in K1, K2, K3. intros [= <-] [(H1 & H2 & H3) ->].
  split; [reflexivity|]. rewrite K1 in H1. rewrite K2 in H2. rewrite K3 in H3. apply holds_const, abs_in in H1, H2, H3.
  unfold in_bounds; cbn [x0 x1 y0 y1 z0 z1]. rewrite !V_add, !V_sub. repeat split; lra.
Qed.

Lemma bounds_of_corners_ok s cs c p a : In c cs -> holds_round c s p a -> forall b, bounds_of_corners cs = Some b ->
  a = Vec 0 0 0 /\ in_bounds b p.
Proof.
  intros I H. induction cs as [|d cs IH]; [destruct I|]. intros b. cbn [bounds_of_corners]. destruct cs as [|e cs].
  - destruct I as [->|[]]. intros E. exact (bounds_of_corner_ok s c b p a E H).
  - destruct (bounds_of_corner d) as [x|] eqn:D; [|discriminate].
    destruct (bounds_of_corners (e :: cs)) as [y|]; [|discriminate]. intros [= <-]. destruct I as [->|I].
    + destruct (bounds_of_corner_ok s c x p a D H) as [A B]. split; [exact A | apply both_bounds_ok; left; exact B].
    + destruct (IH I y eq_refl) as [A B]. split; [exact A | apply both_bounds_ok; right; exact B].
Qed.

Lemma bounds_of_ok o b : bounds_of o = Some b -> bounded b o.
Proof.
  destruct o as [cs r|]; [|discriminate]. cbn [bounds_of]. destruct (Z.leb_spec r 0) as [R|]; [|discriminate].
  intros E s x C. cbn [covers] in C. apply V_le in R. rewrite V_0 in R.
  assert (K : forall v, exists p, in_bounds b p /\ dot v x <= dot v p).
  { intros v. destruct (C v) as (c & p & a & I & H & L). destruct (bounds_of_corners_ok s cs c p a I H b E) as [-> B].
    exists p. split; [exact B|]. rewrite norm_nil in L. pose proof (norm_nonneg v). nra. }
  destruct (K (Vec 1 0 0)) as (p1 & B1 & L1). destruct (K (Vec (-1) 0 0)) as (p2 & B2 & L2).
  destruct (K (Vec 0 1 0)) as (p3 & B3 & L3). destruct (K (Vec 0 (-1) 0)) as (p4 & B4 & L4).
  destruct (K (Vec 0 0 1)) as (p5 & B5 & L5). destruct (K (Vec 0 0 (-1))) as (p6 & B6 & L6).
  unfold in_bounds, dot in *; cbn [vx vy vz] in *. repeat split; lra.
Qed.

(** ** Pieces in a tree

    In their order. A group has bounds, or none; a piece of the tree is within those of all groups that have it. *)
Inductive forest :=
  | Piece (o : outline)
  | Group (size : nat) (b : option bounds) (l r : forest).

Fixpoint has (t : forest) (o : outline) : Prop :=
  match t with
  | Piece p => p = o
  | Group _ b l r => (has l o \/ has r o) /\ match b with Some x => bounded x o | None => True end
  end.

Definition count (t : forest) : nat := match t with Piece _ => 1%nat | Group n _ _ _ => n end.

(** The first k pieces and the others; none if there are no such. *)
Fixpoint split (k : nat) (t : forest) : option (forest * forest) :=
  match t with
  | Piece _ => None
  | Group n b l r =>
      let c := count l in
      if Nat.ltb k c then match split k l with Some (l1, l2) => Some (l1, Group (n - k) b l2 r) | None => None end
      else if Nat.eqb k c then Some (l, r)
      else match split (k - c) r with Some (r1, r2) => Some (Group k b l r1, r2) | None => None end
  end.

Lemma split_has t o : forall k l r, split k t = Some (l, r) -> has t o -> has l o \/ has r o.
Proof.
  induction t as [p | n b l IHl r IHr]; intros k x y; cbn [split]; [discriminate|].
  destruct (Nat.ltb k (count l)); [|destruct (Nat.eqb k (count l))].
  - destruct (split k l) as [[l1 l2]|] eqn:E; [|discriminate]. intros [= <- <-] [H B]. cbn [has].
    destruct H as [H|H]; [destruct (IHl _ _ _ E H)|]; tauto.
  - intros [= <- <-] [H _]. exact H.
  - destruct (split (k - count l) r) as [[r1 r2]|] eqn:E; [|discriminate]. intros [= <- <-] [H B]. cbn [has].
    destruct H as [H|H]; [|destruct (IHr _ _ _ E H)]; tauto.
Qed.

(** A list as a tree: by halves, with bounds for groups of four and more. *)
Definition no_piece : outline := Outline [] 0.
Fixpoint in_a_row (o : outline) (os : list outline) : forest :=
  match os with [] => Piece o | p :: rest => Group (S (length os)) None (Piece o) (in_a_row p rest) end.

Fixpoint grow (fuel : nat) (os : list outline) : forest * option bounds :=
  match os with
  | [] => (Piece no_piece, None)
  | [o] => (Piece o, bounds_of o)
  | o :: rest =>
      match fuel with
      | O => (in_a_row o rest, None)
      | S n =>
          let size := length os in
          let k := Nat.div size 2 in
          let (l, a) := grow n (firstn k os) in
          let (r, b) := grow n (skipn k os) in
          let both := join_bounds a b in
          (Group size (if Nat.leb 4 size then both else None) l r, both)
      end
  end.
Definition forest_of (os : list outline) : forest := fst (grow 64 os).

Lemma in_a_row_has os : forall o p, In p (o :: os) -> has (in_a_row o os) p.
Proof.
  induction os as [|q os IH]; intros o p I; cbn [in_a_row has].
  - destruct I as [->|[]]. reflexivity.
  - split; [|exact Logic.I]. destruct I as [->|I]; [left; reflexivity | right; apply IH; exact I].
Qed.

Lemma grow_has fuel : forall os o, In o os ->
  has (fst (grow fuel os)) o /\ forall b, snd (grow fuel os) = Some b -> bounded b o.
Proof.
  induction fuel as [|n IH]; intros os o I; (destruct os as [|p [|q os]]; [destruct I | |]).
  - destruct I as [->|[]]. split; [reflexivity | apply bounds_of_ok].
  - cbn [grow fst snd]. split; [apply in_a_row_has; exact I | discriminate].
  - destruct I as [->|[]]. split; [reflexivity | apply bounds_of_ok].
  - cbn [grow]. set (os' := p :: q :: os) in *. set (k := Nat.div (length os') 2).
    pose proof (IH (firstn k os') o) as L. pose proof (IH (skipn k os') o) as R.
    destruct (grow n (firstn k os')) as [l a]. destruct (grow n (skipn k os')) as [r b]. cbn [fst snd] in *.
    rewrite <- (firstn_skipn k os') in I. apply in_app_or in I.
    assert (B : forall x, join_bounds a b = Some x -> bounded x o).
    { intros x E s y C. destruct a as [a|], b as [b|]; try discriminate. injection E as <-. apply both_bounds_ok.
      destruct I as [I|I]; [left; exact (proj2 (L I) a eq_refl s y C) | right; exact (proj2 (R I) b eq_refl s y C)]. }
    split; [|exact B]. cbn [has]. split; [destruct I as [I|I]; [left; apply L | right; apply R]; exact I|].
    destruct (Nat.leb 4 (length os')); [|exact Logic.I]. destruct (join_bounds a b) as [x|]; [exact (B x eq_refl) | exact Logic.I].
Qed.

Lemma forest_of_has os o : In o os -> has (forest_of os) o.
Proof. intros I. apply (grow_has 64 os o I). Qed.

(** ** How far pieces reach *)

(** No bound of one of two is none of both. *)
Definition upper_join (a b : option upper) : option upper :=
  match a, b with Some u, Some w => Some (upper_max u w) | _, _ => None end.

(** Above the length of a vector of models. With l the linear part, the length |l(s)| is convex: not above the line
    between its values at s = -1 and s = 1. The rest adds its magnitude. *)
Definition end_length (v : tvec) (sign : Z) : Z :=
  let x := (c0 (tx v) + sign * c1 (tx v))%Z in
  let y := (c0 (ty v) + sign * c1 (ty v))%Z in
  let z := (c0 (tz v) + sign * c1 (tz v))%Z in Z.sqrt_up (x * x + y * y + z * z).
Definition chord (v : tvec) : upper :=
  let e0 := end_length v (-1) in let e1 := end_length v 1 in
  let rest := (Z.abs (c2 (tx v)) + rem (tx v) + (Z.abs (c2 (ty v)) + rem (ty v)) + (Z.abs (c2 (tz v)) + rem (tz v)))%Z in
  Upper (e0 + rest) ((e0 + e1) / 2 + 1 + rest) (e1 + rest).

Definition ttimes (a v : tvec) : tvec := Tvec (tm_mul (tx a) (tx v)) (tm_mul (ty a) (ty v)) (tm_mul (tz a) (tz v)).

Definition corner_reach (f : func) (c : round) : upper :=
  let u := upper_of (tm_add (tdot (centre c) (fv f)) (fd f)) in
  match semiaxes c with None => u | Some a => upper_add u (chord (ttimes a (fv f))) end.

Fixpoint farthest (f : func) (cs : list round) : option upper :=
  match cs with
  | [] => None
  | [c] => Some (corner_reach f c)
  | c :: rest => upper_join (Some (corner_reach f c)) (farthest f rest)
  end.

(** [length]: at least that of the direction. *)
Definition reach_one (f : func) (length : Z) (o : outline) : option upper :=
  match o with
  | Outline corners radius =>
      option_map (fun u => upper_add u (upper_const (mulup (Z.max 0 radius) length))) (farthest f corners)
  | Wall _ _ _ => None
  end.

(** A linear function on a box: in each coordinate one of both ends is the farthest. *)
Definition ends_reach (lo hi : Z) (m : tm) : upper :=
  upper_max (upper_of (tm_mul (const lo 0) m)) (upper_of (tm_mul (const hi 0) m)).
Definition bounds_reach (f : func) (b : bounds) : upper :=
  upper_add (upper_add (upper_add (ends_reach (x0 b) (x1 b) (tx (fv f))) (ends_reach (y0 b) (y1 b) (ty (fv f))))
    (ends_reach (z0 b) (z1 b) (tz (fv f)))) (upper_of (fd f)).
Definition upper_leb (a b : upper) : bool := Z.leb (u0 a) (u0 b) && Z.leb (u1 a) (u1 b) && Z.leb (u2 a) (u2 b).

(** The greater of [best] and what the pieces reach. Groups that don't reach beyond it are passed over. *)
Fixpoint reach_in (f : func) (length : Z) (t : forest) (best : upper) : option upper :=
  match t with
  | Piece o => upper_join (Some best) (reach_one f length o)
  | Group _ b l r =>
      if match b with Some x => upper_leb (bounds_reach f x) best | None => false end then Some best
      else match reach_in f length l best with Some u => reach_in f length r u | None => None end
  end.

(** A piece that is likely to be the farthest, by one of the three coefficients. (Any would do for the proof.) *)
Definition bounds_at (t : forest) : option bounds := match t with Group _ b _ _ => b | Piece o => bounds_of o end.
Fixpoint likely (f : func) (pick : upper -> Z) (t : forest) : outline :=
  match t with
  | Piece o => o
  | Group _ _ l r =>
      match bounds_at l, bounds_at r with
      | Some x, Some y =>
          if Z.ltb (pick (bounds_reach f x)) (pick (bounds_reach f y)) then likely f pick r else likely f pick l
      | _, _ => likely f pick l
      end
  end.

Definition reach (f : func) (length : Z) (t : forest) : option upper :=
  let one pick := reach_one f length (likely f pick t) in
  match t with
  | Piece o => reach_one f length o
  | Group _ None _ _ => match one u1 with Some u => reach_in f length t u | None => None end
  | Group _ (Some _) _ _ =>
      match upper_join (one u0) (upper_join (one u1) (one u2)) with Some u => reach_in f length t u | None => None end
  end.

Definition below_opt (u : option upper) (s y : R) : Prop := match u with Some w => below w s y | None => True end.

Section AtOneTime.
Variable s : R.
Hypothesis Hs : Rabs s <= 1.

Lemma below_join_l a b y : below_opt a s y -> below_opt (upper_join a b) s y.
Proof.
  destruct a, b; cbn; try tauto. intros H. eapply below_mono; [exact Hs | apply upper_max_l | exact H].
Qed.
Lemma below_join_r a b y : below_opt b s y -> below_opt (upper_join a b) s y.
Proof.
  destruct a, b; cbn; try tauto. intros H. eapply below_mono; [exact Hs | apply upper_max_r | exact H].
Qed.

Lemma below_weaken u x y : x <= y -> below u s y -> below u s x.
Proof. unfold below. intros. lra. Qed.

Lemma triangle a b : norm (add a b) <= norm a + norm b.
Proof.
  pose proof (norm_nonneg a). pose proof (norm_nonneg b). pose proof (cauchy a b) as C.
  unfold norm at 1. rewrite <- (sqrt_square (norm a + norm b)) by lra. apply sqrt_le_1_alt.
  assert (Ha : norm a * norm a = dot a a) by (apply sqrt_sqrt, dot_nonneg).
  assert (Hb : norm b * norm b = dot b b) by (apply sqrt_sqrt, dot_nonneg).
  assert (E : dot (add a b) (add a b) = dot a a + 2 * dot a b + dot b b) by (unfold dot, add; cbn; ring). nra.
Qed.

Lemma norm_sum v : norm v <= Rabs (vx v) + Rabs (vy v) + Rabs (vz v).
Proof.
  pose proof (Rabs_pos (vx v)). pose proof (Rabs_pos (vy v)). pose proof (Rabs_pos (vz v)).
  unfold norm. rewrite <- (sqrt_square (Rabs (vx v) + Rabs (vy v) + Rabs (vz v))) by lra. apply sqrt_le_1_alt.
  assert (S : forall x, x * x = Rabs x * Rabs x) by (intros x; rewrite <- Rabs_mult; symmetry; apply Rabs_right; nra).
  unfold dot. rewrite (S (vx v)), (S (vy v)), (S (vz v)). nra.
Qed.

Lemma integer_length x y z : norm (Vec (V x) (V y) (V z)) <= V (Z.sqrt_up (x * x + y * y + z * z)).
Proof.
  unfold norm, dot; cbn [vx vy vz]. set (m := (x * x + y * y + z * z)%Z).
  assert (Hm : (0 <= m)%Z) by (unfold m; nia).
  assert (L : (m <= Z.sqrt_up m * Z.sqrt_up m)%Z).
  { destruct (Z.eq_dec m 0) as [->|N]; [reflexivity|]. apply Z.sqrt_up_spec. lia. }
  pose proof (Z.sqrt_up_nonneg m) as H0.
  assert (E : V x * V x + V y * V y + V z * V z = IZR m * (ulp * ulp)).
  { unfold m, V. rewrite !plus_IZR, !mult_IZR. ring. }
  rewrite E. pose proof ulp_pos. rewrite <- (sqrt_square (V (Z.sqrt_up m))).
  - apply sqrt_le_1_alt. unfold V. replace (IZR (Z.sqrt_up m) * ulp * (IZR (Z.sqrt_up m) * ulp)) with
      (IZR (Z.sqrt_up m * Z.sqrt_up m) * (ulp * ulp)) by (rewrite mult_IZR; ring).
    apply Rmult_le_compat_r; [apply Rmult_le_pos; lra | apply IZR_le; exact L].
  - rewrite <- V_0. apply V_le. exact H0.
Qed.

(** The part of a model that is not linear. *)
Lemma rest_ok m x : holds m s x -> Rabs (x - (V (c0 m) + V (c1 m) * s)) <= V (Z.abs (c2 m) + rem m).
Proof.
  intros H. rewrite V_add, V_abs. unfold holds, poly in H.
  replace (x - _) with ((x - (V (c0 m) + V (c1 m) * s + V (c2 m) * (s * s))) + V (c2 m) * (s * s)) by ring.
  assert (Q : Rabs (s * s) <= 1) by (rewrite <- (Rmult_1_r 1); apply abs_product_le; exact Hs).
  pose proof (abs_times_le (V (c2 m)) (s * s) Q). eapply Rle_trans; [apply Rabs_triang|]. lra.
Qed.

Lemma chord_ok m v : holdsv m s v -> below (chord m) s (norm v).
Proof.
  intros (Hx & Hy & Hz). apply rest_ok in Hx, Hy, Hz.
  set (lin := fun t => Vec (V (c0 (tx m)) + V (c1 (tx m)) * t) (V (c0 (ty m)) + V (c1 (ty m)) * t)
                           (V (c0 (tz m)) + V (c1 (tz m)) * t)).
  set (rest := (Z.abs (c2 (tx m)) + rem (tx m) + (Z.abs (c2 (ty m)) + rem (ty m)) + (Z.abs (c2 (tz m)) + rem (tz m)))%Z).
  assert (E0 : norm (lin (-1)) <= V (end_length m (-1))).
  { unfold end_length. eapply Rle_trans; [|apply integer_length]. apply Req_le. f_equal. unfold lin. 
    f_equal; rewrite V_add; unfold V; rewrite mult_IZR; ring. }
  assert (E1 : norm (lin 1) <= V (end_length m 1)).
  { unfold end_length. eapply Rle_trans; [|apply integer_length]. apply Req_le. f_equal. unfold lin.
    f_equal; rewrite V_add; unfold V; rewrite mult_IZR; ring. }
  assert (R : norm (sub v (lin s)) <= V rest).
  { eapply Rle_trans; [apply norm_sum|]. unfold rest. rewrite (V_add (_ + _ + _)), (V_add (_ + _)).
    unfold sub, add, scale, lin; cbn [vx vy vz].
    replace (vx v + -1 * _) with (vx v - (V (c0 (tx m)) + V (c1 (tx m)) * s)) by ring.
    replace (vy v + -1 * _) with (vy v - (V (c0 (ty m)) + V (c1 (ty m)) * s)) by ring.
    replace (vz v + -1 * _) with (vz v - (V (c0 (tz m)) + V (c1 (tz m)) * s)) by ring. lra. }
  pose proof (abs_in _ _ Hs) as S.
  assert (L : norm (lin s) <= (1 - s) / 2 * norm (lin (-1)) + (1 + s) / 2 * norm (lin 1)).
  { assert (K : forall k w, 0 <= k -> norm (scale k w) = k * norm w).
    { intros k w Hk. unfold norm. replace (dot (scale k w) (scale k w)) with (k * k * dot w w)
        by (unfold dot, scale; cbn; ring).
      rewrite sqrt_mult_alt by (apply Rmult_le_pos; exact Hk). rewrite sqrt_square by exact Hk. reflexivity. }
    rewrite <- !K by lra. replace (lin s) with (add (scale ((1 - s) / 2) (lin (-1))) (scale ((1 + s) / 2) (lin 1))).
    - apply triangle.
    - unfold lin, add, scale; cbn [vx vy vz]. f_equal; field. }
  assert (T : norm v <= norm (lin s) + norm (sub v (lin s))).
  { eapply Rle_trans; [|apply triangle]. apply Req_le. f_equal. destruct v as [p q r]. unfold add, sub, scale, lin.
    unfold add; cbn [vx vy vz]. f_equal; ring. }
  assert (H2 : V (end_length m (-1)) / 2 + V (end_length m 1) / 2 <= V ((end_length m (-1) + end_length m 1) / 2 + 1)).
  { pose proof (divz_err (end_length m (-1) + end_length m 1) 2 ltac:(lia)) as D. unfold divz in D.
    rewrite V_add in D. rewrite V_add, (V_ulps 1). lra. }
  unfold below, chord; cbn [u0 u1 u2]. fold rest. rewrite !(V_add _ rest).
  destruct (weights s Hs) as (W0 & W1 & W2).
  set (e0 := V (end_length m (-1))) in *. set (e1 := V (end_length m 1)) in *.
  set (em := V ((end_length m (-1) + end_length m 1) / 2 + 1)) in *.
  assert (M : (e0 / 2 + e1 / 2) * ((1 - s) * (1 + s) / 2) <= em * ((1 - s) * (1 + s) / 2))
    by (apply Rmult_le_compat_r; assumption).
  assert (Q : (1 - s) / 2 * norm (lin (-1)) + (1 + s) / 2 * norm (lin 1) <= (1 - s) / 2 * e0 + (1 + s) / 2 * e1)
    by (apply Rplus_le_compat; apply Rmult_le_compat_l; lra).
  apply Rle_trans with ((1 - s) / 2 * e0 + (1 + s) / 2 * e1 + V rest); [lra|].
  apply Rle_trans with (e0 * ((1 - s) * (1 - s) / 4) + (e0 / 2 + e1 / 2) * ((1 - s) * (1 + s) / 2) +
    e1 * ((1 + s) * (1 + s) / 4) + V rest); [apply Req_le; field|].
  apply Rle_trans with (e0 * ((1 - s) * (1 - s) / 4) + em * ((1 - s) * (1 + s) / 2) +
    e1 * ((1 + s) * (1 + s) / 4) + V rest); [lra|]. apply Req_le. field.
Qed.

Lemma corner_ok f v d c p a : holdsf s f v d -> holds_round c s p a ->
  below (corner_reach f c) s (dot v p + d + norm (times a v)).
Proof.
  intros [Hv Hd] [Hc Ha]. unfold corner_reach.
  assert (C : below (upper_of (tm_add (tdot (centre c) (fv f)) (fd f))) s (dot v p + d)).
  { apply below_of. apply holds_add; [|exact Hd].
    eapply holds_eq; [|apply holds_dot; [exact Hs | exact Hc | exact Hv]]. unfold dot. ring. }
  destruct (semiaxes c) as [am|].
  - apply below_add; [exact C|]. apply chord_ok. destruct Ha as (A1 & A2 & A3), Hv as (V1 & V2 & V3).
    repeat split; apply holds_mul; assumption.
  - subst a. rewrite norm_nil, Rplus_0_r. exact C.
Qed.

Lemma farthest_ok f v d cs c p a : holdsf s f v d -> In c cs -> holds_round c s p a ->
  below_opt (farthest f cs) s (dot v p + d + norm (times a v)).
Proof.
  intros Hf I Hc. pose proof (corner_ok f v d c p a Hf Hc) as K. induction cs as [|c' cs IH]; [destruct I|].
  cbn [farthest]. destruct cs as [|c'' cs].
  - destruct I as [->|[]]. exact K.
  - destruct I as [->|I]; [apply below_join_l; exact K | apply below_join_r; apply IH; exact I].
Qed.

Lemma reach_one_ok f v d l o x : holdsf s f v d -> norm v <= V l -> covers s o x ->
  below_opt (reach_one f l o) s (dot v x + d).
Proof.
  intros Hf Hl C. destruct o as [corners radius|]; [|exact I]. destruct (C v) as (c & p & a & Ic & Hc & L).
  pose proof (farthest_ok f v d corners c p a Hf Ic Hc) as F. unfold reach_one.
  destruct (farthest f corners) as [u|]; [|exact I]. cbn [option_map below_opt] in *.
  apply below_weaken with ((dot v p + d + norm (times a v)) + V radius * norm v); [lra|].
  apply below_add; [exact F|]. apply below_const.
  pose proof (norm_nonneg v). destruct (V_max 0 radius) as [M1 M2]. rewrite V_0 in M1.
  apply Rle_trans with (V (Z.max 0 radius) * norm v); [apply Rmult_le_compat_r; assumption|].
  eapply Rle_trans; [|apply mulup_ge]. apply Rmult_le_compat_l; assumption.
Qed.

Lemma ends_reach_ok lo hi m k y : holds m s k -> V lo <= y <= V hi -> below (ends_reach lo hi m) s (k * y).
Proof.
  intros H B. unfold ends_reach. destruct (Rle_lt_dec 0 k) as [P|N].
  - apply below_weaken with (V hi * k); [nra|]. eapply below_mono; [exact Hs | apply upper_max_r|].
    apply below_of. apply holds_mul; [exact Hs | apply holds_exact | exact H].
  - apply below_weaken with (V lo * k); [nra|]. eapply below_mono; [exact Hs | apply upper_max_l|].
    apply below_of. apply holds_mul; [exact Hs | apply holds_exact | exact H].
Qed.

Lemma bounds_reach_ok f v d b x : holdsf s f v d -> in_bounds b x -> below (bounds_reach f b) s (dot v x + d).
Proof.
  intros [(H1 & H2 & H3) Hd] (B1 & B2 & B3). unfold bounds_reach, dot.
  repeat apply below_add; try (apply ends_reach_ok; assumption). apply below_of. exact Hd.
Qed.

Lemma upper_leb_ok a b : upper_leb a b = true -> upper_le a b.
Proof. unfold upper_leb, upper_le. rewrite !andb_true_iff, !Z.leb_le. tauto. Qed.

Lemma reach_in_ok f v d l t : holdsf s f v d -> norm v <= V l -> forall best u, reach_in f l t best = Some u ->
  (forall y, below best s y -> below u s y) /\ forall o x, has t o -> covers s o x -> below u s (dot v x + d).
Proof.
  intros Hf Hl. induction t as [o | n b t1 IH1 t2 IH2]; intros best u; cbn [reach_in has].
  - destruct (reach_one f l o) as [w|] eqn:R; [|discriminate]. cbn [upper_join]. intros [= <-]. split.
    + intros y. apply below_mono; [exact Hs | apply upper_max_l].
    + intros o' x -> C. pose proof (reach_one_ok f v d l o' x Hf Hl C) as K. rewrite R in K. cbn [below_opt] in K.
      eapply below_mono; [exact Hs | apply upper_max_r | exact K].
  - destruct (match b with Some x => upper_leb (bounds_reach f x) best | None => false end) eqn:P.
    + intros [= <-]. split; [auto|]. intros o x [_ B] C. destruct b as [b|]; [|discriminate].
      eapply below_mono; [exact Hs | apply upper_leb_ok; exact P|]. apply bounds_reach_ok; [exact Hf | exact (B s x C)].
    + destruct (reach_in f l t1 best) as [w|] eqn:E1; [|discriminate]. intros E2.
      destruct (IH1 _ _ E1) as [M1 K1]. destruct (IH2 _ _ E2) as [M2 K2]. split; [auto|].
      intros o x [[H|H] _] C; [apply M2; exact (K1 o x H C) | exact (K2 o x H C)].
Qed.

Lemma reach_ok f v d l t o x : holdsf s f v d -> norm v <= V l -> has t o -> covers s o x ->
  below_opt (reach f l t) s (dot v x + d).
Proof.
  intros Hf Hl I C.
  assert (K : forall start, below_opt (match start with Some u => reach_in f l t u | None => None end) s (dot v x + d)).
  { intros [u|]; [|exact Logic.I]. destruct (reach_in f l t u) as [w|] eqn:R; [|exact Logic.I].
    exact (proj2 (reach_in_ok f v d l t Hf Hl u w R) o x I C). }
  unfold reach. destruct t as [p | n [b|] t1 t2]; [|apply K | apply K].
  cbn [has] in I. subst p. exact (reach_one_ok f v d l o x Hf Hl C).
Qed.

End AtOneTime.
